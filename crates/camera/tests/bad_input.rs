//! Damaged, missing and mistaken recordings: an error that says what and where, or a lost frame and the next.

mod made;

use made::{FRAMES, SIZE, fast, is_image_of, next, start};
use roadwatch_camera::{
    AnyRecording, DatasetError, DecodeCount, FrameRate, ImageSequence, Playback, Player, Recording,
    Repeat, RigDataset, SequenceError, StampedFile, VideoError, VideoFile,
};
use roadwatch_core::{CameraId, Frame, ImageSize, SourceError};
use std::{
    error::Error,
    fs, io,
    path::{Path, PathBuf},
    sync::{Arc, Mutex},
};

fn once(recording: impl Recording + 'static) -> Player<impl Recording> {
    let playback = Playback::new(fast(Repeat::Once, None), &[recording.span()]);
    Player::new(CameraId(0), recording, playback)
}

/// A dataset after `spoil` had its way with the folder, played once as `front`.
fn front_of_spoiled(spoil: impl Fn(&Path)) -> (tempfile::TempDir, Player<AnyRecording>) {
    let root = tempfile::tempdir().expect("a folder");
    let folder = made::rig_dataset(root.path());
    spoil(&folder.join("front"));
    let dataset = RigDataset::open(&folder).expect("a dataset");
    let front = dataset.recording(0).expect("a camera").expect("plays");
    let playback = dataset.playback(fast(Repeat::Once, None));
    (root, Player::new(CameraId(0), front, playback))
}

fn complaint(frame: &Frame) -> String {
    let error = frame.image.pixels().expect_err("spoiled");
    error.to_string()
}

#[test]
fn a_spoiled_image_fails_alone_and_says_why() {
    let (_root, mut source) = front_of_spoiled(|front| {
        let whole = fs::read(front.join("0000.jpg")).expect("an image");
        fs::write(front.join("0001.jpg"), b"").expect("written");
        fs::write(front.join("0002.jpg"), &whole[..whole.len() / 2]).expect("written");
        fs::write(front.join("0003.jpg"), "dear diary").expect("written");
        let large = ImageSize {
            width_px: 80,
            height_px: 60,
        };
        made::write_image(&front.join("0004.jpg"), large, 4);
    });
    let frames: Vec<Frame> = (0..FRAMES)
        .map(|_| next(&mut source).expect("a frame"))
        .collect();
    for (index, expected) in [
        (1, "front/0001.jpg`: the file is empty"),
        (2, "front/0002.jpg`: the image is truncated"),
        (3, "front/0003.jpg`: neither a JPEG nor a PNG"),
        (4, "front/0004.jpg`: image is 80x60, the rig says 64x48"),
    ] {
        let complaint = complaint(&frames[index]);
        assert!(complaint.contains(expected), "{complaint}");
    }
    for index in [0, 5, 6, 7, 8, 9] {
        assert!(is_image_of(&frames[index], index));
    }
}

#[test]
fn a_missing_image_is_a_lost_frame_and_the_next_comes() {
    let (_root, mut source) = front_of_spoiled(|front| {
        fs::remove_file(front.join("0001.jpg")).expect("removed");
    });
    assert_eq!(next(&mut source).expect("a frame").seq, 0);
    let Err(SourceError::FrameLost(cause)) = next(&mut source) else {
        panic!("the file is gone");
    };
    assert!(cause.to_string().contains("front/0001.jpg"), "{cause}");
    let after = next(&mut source).expect("a frame");
    assert_eq!(after.seq, 2);
    assert!(is_image_of(&after, 2));
}

#[test]
fn frames_nobody_looks_at_are_never_decoded() {
    let root = tempfile::tempdir().expect("a folder");
    let dataset = RigDataset::open(&made::rig_dataset(root.path())).expect("a dataset");
    let decodes = DecodeCount::default();
    let front = dataset
        .recording(0)
        .expect("a camera")
        .expect("plays")
        .counting(decodes.clone());
    let playback = dataset.playback(fast(Repeat::Once, None));
    let mut source = Player::new(CameraId(0), front, playback);
    for at in 0..FRAMES {
        let frame = next(&mut source).expect("a frame");
        if at % 5 == 0 {
            let copy = frame.clone();
            assert!(is_image_of(&frame, at) && is_image_of(&copy, at));
        }
    }
    assert_eq!(decodes.get(), 2);
}

/// Puts a mistake into a dataset's folder.
type Spoil = Box<dyn Fn(&Path)>;

fn opened(spoil: impl Fn(&Path)) -> Result<RigDataset, DatasetError> {
    let root = tempfile::tempdir().expect("a folder");
    let folder = made::rig_dataset(root.path());
    spoil(&folder);
    RigDataset::open(&folder)
}

#[test]
fn a_dataset_with_a_mistake_is_refused_with_file_and_line() {
    let replace = |file: &'static str, from: &'static str, to: &'static str| {
        move |folder: &Path| {
            let text = fs::read_to_string(folder.join(file)).expect("text");
            assert!(text.contains(from), "{from}");
            fs::write(folder.join(file), text.replacen(from, to, 1)).expect("written");
        }
    };
    let cases: [(Spoil, &str); 6] = [
        (
            Box::new(replace("rig.toml", "fx =", "f_x =")),
            "rig.toml:5: unknown field `f_x`",
        ),
        (
            Box::new(replace("rig.toml", "\"back\"", "\"front\"")),
            "rig.toml:13: two cameras are called `front`",
        ),
        (
            Box::new(replace("frames.jsonl", "956.239383", "956.139383")),
            "frames.jsonl:3: camera `front`: the stamp",
        ),
        (
            Box::new(replace("frames.jsonl", "\"back\"", "\"rear\"")),
            "frames.jsonl:1: camera `rear` is not in rig.toml",
        ),
        (
            Box::new(|folder| fs::remove_dir_all(folder.join("back")).expect("removed")),
            "camera `back` has no images",
        ),
        (
            Box::new(|folder| fs::remove_file(folder.join("rig.toml")).expect("removed")),
            "rig.toml` cannot be read",
        ),
    ];
    for (spoil, expected) in cases {
        let error = opened(spoil).expect_err(expected).to_string();
        assert!(error.contains(expected), "{error}");
    }
}

#[test]
fn a_camera_without_any_stamp_is_refused() {
    let error = opened(|folder| {
        fs::write(
            folder.join("frames.jsonl"),
            "{\"frame\":0,\"stamp\":{\"front\":1.5}}\n",
        )
        .expect("written");
    })
    .expect_err("no stamp for back");
    assert!(
        error.to_string().starts_with("camera `back` has no stamp"),
        "{error}"
    );
}

#[test]
fn a_sequence_needs_images_in_order() {
    let root = tempfile::tempdir().expect("a folder");
    let rate = FrameRate::from_hz(10.0).expect("a rate");
    let open = |folder: &Path| ImageSequence::open(folder, SIZE, rate, start());
    assert!(matches!(
        open(root.path()),
        Err(SequenceError::NoImages { .. })
    ));
    let missing = root.path().join("missing");
    assert!(matches!(
        open(&missing),
        Err(SequenceError::Unreadable { .. })
    ));
    let file = |name: &str| StampedFile {
        file: name.into(),
        stamp: start(),
    };
    let twice = ImageSequence::from_files(vec![file("a.jpg"), file("b.jpg")], SIZE);
    assert!(matches!(twice, Err(SequenceError::StampsFall { .. })));
    let none = ImageSequence::from_files(Vec::new(), SIZE);
    assert!(matches!(none, Err(SequenceError::Empty)));
}

fn motion_jpeg(root: &Path) -> PathBuf {
    let file = root.join("clip.avi");
    made::video(&file, ['M', 'J', 'P', 'G'], 40);
    file
}

/// Everything logged in this thread while it lives.
#[derive(Clone, Default)]
struct Log(Arc<Mutex<Vec<u8>>>);

impl Log {
    fn listen(&self) -> tracing::subscriber::DefaultGuard {
        let log = self.clone();
        let subscriber = tracing_subscriber::fmt()
            .with_ansi(false)
            .with_writer(move || log.clone())
            .finish();
        tracing::subscriber::set_default(subscriber)
    }

    fn text(&self) -> String {
        String::from_utf8(self.0.lock().expect("whole").clone()).expect("text")
    }
}

impl io::Write for Log {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().expect("whole").extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn cut_in_half(file: &Path) {
    let whole = fs::read(file).expect("a video");
    fs::write(file, &whole[..whole.len() / 2]).expect("written");
}

#[test]
fn a_video_cut_in_the_middle_plays_as_far_as_it_goes_and_warns() {
    let root = tempfile::tempdir().expect("a folder");
    let file = motion_jpeg(root.path());
    cut_in_half(&file);
    let log = Log::default();
    let _listening = log.listen();
    let mut source = once(VideoFile::open(&file, SIZE, start()).expect("a video"));
    let mut played: u64 = 0;
    let end = loop {
        match next(&mut source) {
            Ok(frame) => assert_eq!(frame.seq, played),
            Err(end) => break end,
        }
        played += 1;
    };
    assert!(matches!(end, SourceError::EndOfStream), "{end}");
    assert!((1..40).contains(&played), "{played} of 40 frames");
    assert!(matches!(next(&mut source), Err(SourceError::EndOfStream)));
    let warning = format!("frames_read={played} frames_in_header=40");
    let text = log.text();
    assert_eq!(text.matches("WARN").count(), 1, "{text}");
    assert!(
        text.contains("clip.avi") && text.contains(&warning),
        "{text}"
    );
}

#[test]
fn a_cut_video_loops_with_rising_stamps() {
    let root = tempfile::tempdir().expect("a folder");
    let file = motion_jpeg(root.path());
    cut_in_half(&file);
    let log = Log::default();
    let _listening = log.listen();
    let video = VideoFile::open(&file, SIZE, start()).expect("a video");
    let playback = Playback::new(fast(Repeat::Loop, None), &[video.span()]);
    let mut source = Player::new(CameraId(0), video, playback);
    let stamps: Vec<_> = (0..100)
        .map(|_| next(&mut source).expect("a frame").captured_at)
        .collect();
    assert!(stamps.is_sorted_by(|a, b| a < b));
    assert_eq!(
        log.text().matches("WARN").count(),
        1,
        "one lap says it for all"
    );
}

#[test]
fn what_is_no_video_is_refused_by_name() {
    let root = tempfile::tempdir().expect("a folder");
    let text = root.path().join("text.mp4");
    fs::write(&text, "this is not a video\n".repeat(50)).expect("written");
    let empty = root.path().join("empty.avi");
    fs::write(&empty, b"").expect("written");
    let cut = root.path().join("cut.mp4");
    made::video(&cut, ['m', 'p', '4', 'v'], 40);
    cut_in_half(&cut);
    for file in [text, empty, cut] {
        let error = VideoFile::open(&file, SIZE, start()).expect_err("no video");
        assert!(matches!(error, VideoError::NotAVideo { .. }), "{error}");
        assert!(
            error.to_string().contains(&file.display().to_string()),
            "{error}"
        );
    }
    let missing = VideoFile::open(&root.path().join("missing.mp4"), SIZE, start());
    let Err(error @ VideoError::Unreadable { .. }) = missing else {
        panic!("{missing:?}");
    };
    assert!(error.source().is_some());
}

#[test]
fn a_video_of_another_size_is_refused_at_open() {
    let root = tempfile::tempdir().expect("a folder");
    let file = motion_jpeg(root.path());
    let rig = ImageSize {
        width_px: 960,
        height_px: 540,
    };
    let error = VideoFile::open(&file, rig, start()).expect_err("another size");
    assert!(
        error
            .to_string()
            .ends_with("clip.avi` is 64x48, the rig says 960x540"),
        "{error}"
    );
}

#[test]
fn a_clip_with_another_number_of_frames_than_stamps_is_refused() {
    let root = tempfile::tempdir().expect("a folder");
    let folder = made::rig_dataset(root.path());
    made::clip_instead_of_images(&folder, "front", FRAMES - 1);
    let dataset = RigDataset::open(&folder).expect("a dataset");
    let error = dataset
        .recording(0)
        .expect("a camera")
        .expect_err("frames are missing");
    let text = roadwatch_core::error_chain(&error);
    assert!(text.contains("camera `front`"), "{text}");
    assert!(
        text.contains(&format!("has {} frames, and {FRAMES} stamps", FRAMES - 1)),
        "{text}"
    );
}
