//! Recordings made for the tests: images and videos of one grey level per frame, so that each is recognised.

use opencv::{
    core::{Mat, Scalar, Size, Vec3b, Vector},
    imgcodecs::imwrite,
    prelude::*,
    videoio::{CAP_FFMPEG, VideoWriter},
};
use roadwatch_camera::{Pace, PlaybackOptions, Repeat};
use roadwatch_core::{Frame, FrameSource, ImageSize, SourceError, Timestamp};
use std::{
    fmt::Write,
    fs,
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

pub(crate) const SIZE: ImageSize = ImageSize {
    width_px: 64,
    height_px: 48,
};
pub(crate) const FRAMES: usize = 10;
pub(crate) const RATE_HZ: f64 = 10.0;
/// Nothing here waits this long unless it hangs.
pub(crate) const PATIENCE: Duration = Duration::from_secs(20);

pub(crate) fn start() -> Timestamp {
    "1557539956.439383".parse().expect("a stamp")
}

pub(crate) fn fast(repeat: Repeat, frame_limit: Option<u64>) -> PlaybackOptions {
    PlaybackOptions {
        pace: Pace::AsFastAsPossible,
        repeat,
        frame_limit,
    }
}

pub(crate) fn next(source: &mut dyn FrameSource) -> Result<Frame, SourceError> {
    source.next_frame(Instant::now() + PATIENCE)
}

/// Grey levels far enough apart to survive lossy codecs.
fn grey_of(index: usize) -> u8 {
    u8::try_from(20 + 20 * index).expect("few frames")
}

pub(crate) fn is_image_of(frame: &Frame, index: usize) -> bool {
    let pixels = frame.image.pixels().expect("decodes");
    let middle = pixels.bgr()[pixels.bgr().len() / 2];
    pixels.size() == SIZE && middle.abs_diff(grey_of(index)) < 8
}

fn grey_image(size: ImageSize, index: usize) -> Mat {
    Mat::new_rows_cols_with_default(
        i32::try_from(size.height_px).expect("small"),
        i32::try_from(size.width_px).expect("small"),
        Vec3b::opencv_type(),
        Scalar::all(f64::from(grey_of(index))),
    )
    .expect("an image")
}

pub(crate) fn write_image(file: &Path, size: ImageSize, index: usize) {
    assert!(imwrite(file, &grey_image(size, index), &Vector::new()).expect("written"));
}

pub(crate) fn video(file: &Path, codec: [char; 4], frames: usize) {
    let [a, b, c, d] = codec;
    let mut writer = VideoWriter::new_with_backend(
        file,
        CAP_FFMPEG,
        VideoWriter::fourcc(a, b, c, d).expect("a code"),
        RATE_HZ,
        Size::new(64, 48),
        true,
    )
    .expect("a writer");
    assert!(writer.is_opened().expect("asked"), "{}", file.display());
    for index in 0..frames {
        writer
            .write(&grey_image(SIZE, index % FRAMES))
            .expect("written");
    }
    writer.release().expect("closed");
}

/// Two cameras, `back` 50 ms after `front`.
pub(crate) fn rig_dataset(root: &Path) -> PathBuf {
    let folder = root.join("dataset");
    let mut rig = String::new();
    for camera in ["front", "back"] {
        fs::create_dir_all(folder.join(camera)).expect("a folder");
        for index in 0..FRAMES {
            let file = folder.join(camera).join(format!("{index:04}.jpg"));
            write_image(&file, SIZE, index);
        }
        write!(
            rig,
            "[[camera]]\nname = \"{camera}\"\nwidth = 64\nheight = 48\nfx = 50.0\nfy = 50.0\ncx = 31.5\n\
             cy = 23.5\nposition_m = [0, 0, 1.5]\norientation_wxyz = [0.5, -0.5, 0.5, -0.5]\n\n"
        )
        .expect("text");
    }
    let lines = (0..FRAMES).map(|index| {
        format!(
            "{{\"frame\": {index}, \"stamp\": {{\"front\": 1557539956.{:06}, \"back\": 1557539956.{:06}}}}}\n",
            index * 100_000 + 39_383,
            index * 100_000 + 89_383,
        )
    });
    fs::write(folder.join("rig.toml"), rig).expect("written");
    fs::write(folder.join("frames.jsonl"), lines.collect::<String>()).expect("written");
    folder
}

/// Puts a clip of `frames` frames in the place of a camera's images.
pub(crate) fn clip_instead_of_images(dataset: &Path, camera: &str, frames: usize) {
    fs::remove_dir_all(dataset.join(camera)).expect("removed");
    let file = dataset.join(format!("{camera}.mp4"));
    video(&file, ['m', 'p', '4', 'v'], frames);
}
