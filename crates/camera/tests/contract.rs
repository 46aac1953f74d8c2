//! What every recorded source promises, checked on each kind.

mod made;

use made::{FRAMES, RATE_HZ, SIZE, fast, is_image_of, next, start};
use roadwatch_camera::{
    FrameRate, ImageSequence, Pace, Playback, PlaybackOptions, Player, Recording, Repeat,
    RigDataset, Speed, VideoFile,
};
use roadwatch_core::{CameraId, FrameSource, SourceError};
use std::{
    fs,
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

const CAMERA: CameraId = CameraId(3);

type MakeSource = fn(&Path, PlaybackOptions) -> Box<dyn FrameSource>;

fn rig_dataset(root: &Path, options: PlaybackOptions) -> Box<dyn FrameSource> {
    let dataset = RigDataset::open(&made::rig_dataset(root)).expect("a dataset");
    let recording = dataset.recording(0).expect("a camera").expect("plays");
    Box::new(Player::new(CAMERA, recording, dataset.playback(options)))
}

fn rig_dataset_of_clips(root: &Path, options: PlaybackOptions) -> Box<dyn FrameSource> {
    let folder = made::rig_dataset(root);
    made::clip_instead_of_images(&folder, "front", FRAMES);
    let dataset = RigDataset::open(&folder).expect("a dataset");
    let recording = dataset.recording(0).expect("a camera").expect("plays");
    Box::new(Player::new(CAMERA, recording, dataset.playback(options)))
}

fn recorded(factor: f64) -> PlaybackOptions {
    PlaybackOptions {
        pace: Pace::Recorded {
            speed: Speed::new(factor).expect("a speed"),
        },
        repeat: Repeat::Once,
        frame_limit: None,
    }
}

fn alone(recording: impl Recording + 'static, options: PlaybackOptions) -> Box<dyn FrameSource> {
    let playback = Playback::new(options, &[recording.span()]);
    Box::new(Player::new(CAMERA, recording, playback))
}

/// `1.jpg`, `2.jpg` ... `10.jpg`, and a file that is no image.
fn numbered_images(root: &Path) -> PathBuf {
    let folder = root.join("images");
    fs::create_dir(&folder).expect("a folder");
    for index in 0..FRAMES {
        made::write_image(&folder.join(format!("{}.jpg", index + 1)), SIZE, index);
    }
    fs::write(folder.join("notes.txt"), "not an image").expect("written");
    folder
}

fn image_folder(root: &Path, options: PlaybackOptions) -> Box<dyn FrameSource> {
    let folder = numbered_images(root);
    let rate = FrameRate::from_hz(RATE_HZ).expect("a rate");
    let sequence = ImageSequence::open(&folder, SIZE, rate, start()).expect("a sequence");
    alone(sequence, options)
}

fn motion_jpeg(root: &Path, options: PlaybackOptions) -> Box<dyn FrameSource> {
    let file = root.join("clip.avi");
    made::video(&file, ['M', 'J', 'P', 'G'], FRAMES);
    alone(
        VideoFile::open(&file, SIZE, start()).expect("a video"),
        options,
    )
}

fn mpeg4(root: &Path, options: PlaybackOptions) -> Box<dyn FrameSource> {
    let file = root.join("clip.mp4");
    made::video(&file, ['m', 'p', '4', 'v'], FRAMES);
    alone(
        VideoFile::open(&file, SIZE, start()).expect("a video"),
        options,
    )
}

fn matroska(root: &Path, options: PlaybackOptions) -> Box<dyn FrameSource> {
    let file = root.join("clip.mkv");
    made::video(&file, ['m', 'p', '4', 'v'], FRAMES);
    alone(
        VideoFile::open(&file, SIZE, start()).expect("a video"),
        options,
    )
}

const KINDS: [(&str, MakeSource); 6] = [
    ("rig dataset", rig_dataset),
    ("rig dataset of clips", rig_dataset_of_clips),
    ("image folder", image_folder),
    ("motion jpeg", motion_jpeg),
    ("mpeg-4", mpeg4),
    ("matroska", matroska),
];

fn on_every_kind(options: PlaybackOptions, check: impl Fn(&str, &mut dyn FrameSource)) {
    for (kind, make) in KINDS {
        let root = tempfile::tempdir().expect("a folder");
        check(kind, make(root.path(), options).as_mut());
    }
}

fn assert_ended(kind: &str, source: &mut dyn FrameSource) {
    for _ in 0..3 {
        let answer = next(source);
        assert!(
            matches!(answer, Err(SourceError::EndOfStream)),
            "{kind}: {answer:?}"
        );
    }
}

/// Takes `count` frames; checks numbers, images, and that stamps are exactly one interval apart.
fn assert_frames(kind: &str, source: &mut dyn FrameSource, count: usize) {
    let mut previous = None;
    for at in 0..count {
        let asked = Instant::now();
        let frame = next(source).unwrap_or_else(|error| panic!("{kind}: frame {at}: {error}"));
        assert_eq!((frame.camera, frame.seq), (CAMERA, at as u64), "{kind}");
        assert!(is_image_of(&frame, at % FRAMES), "{kind}: frame {at}");
        assert!(frame.received_at >= asked && frame.received_at <= Instant::now());
        if let Some(previous) = previous {
            let apart = frame.captured_at.saturating_since(previous);
            assert_eq!(apart, Duration::from_millis(100), "{kind}: frame {at}");
        }
        previous = Some(frame.captured_at);
    }
}

#[test]
fn all_frames_come_in_order_and_then_the_end_for_good() {
    on_every_kind(fast(Repeat::Once, None), |kind, source| {
        assert_frames(kind, source, FRAMES);
        assert_ended(kind, source);
    });
}

#[test]
fn a_loop_goes_on_with_rising_stamps() {
    on_every_kind(fast(Repeat::Loop, None), |kind, source| {
        assert_frames(kind, source, FRAMES * 5 / 2);
    });
}

#[test]
fn a_frame_limit_ends_the_stream() {
    for repeat in [Repeat::Once, Repeat::Loop] {
        on_every_kind(fast(repeat, Some(4)), |kind, source| {
            assert_frames(kind, source, 4);
            assert_ended(kind, source);
        });
    }
    on_every_kind(fast(Repeat::Loop, Some(23)), |kind, source| {
        assert_frames(kind, source, 23);
        assert_ended(kind, source);
    });
}

#[test]
fn a_frame_that_is_not_due_waits_for_the_deadline_only() {
    on_every_kind(recorded(0.005), |kind, source| {
        assert_eq!(next(source).expect("the first is due").seq, 0, "{kind}");
        for _ in 0..2 {
            let deadline = Instant::now() + Duration::from_millis(30);
            let answer = source.next_frame(deadline);
            let late = Instant::now().checked_duration_since(deadline);
            assert!(
                matches!(answer, Err(SourceError::Timeout)),
                "{kind}: {answer:?}"
            );
            let late = late.unwrap_or_else(|| panic!("{kind}: answered before the deadline"));
            // The frame itself is due in twenty seconds; a busy machine is late by far less.
            assert!(late < Duration::from_secs(5), "{kind}: {late:?} late");
        }
    });
}

#[test]
fn a_timeout_loses_no_frame() {
    on_every_kind(recorded(2.0), |kind, source| {
        let mut seqs = Vec::new();
        while seqs.len() < FRAMES {
            match source.next_frame(Instant::now() + Duration::from_millis(10)) {
                Ok(frame) => seqs.push(frame.seq),
                Err(SourceError::Timeout) => {}
                Err(error) => panic!("{kind}: {error}"),
            }
        }
        assert!(seqs.into_iter().eq(0..FRAMES as u64), "{kind}");
        assert_ended(kind, source);
    });
}

#[test]
fn recorded_pace_takes_as_long_as_the_recording_did() {
    on_every_kind(recorded(3.0), |kind, source| {
        let asked = Instant::now();
        assert_frames(kind, source, FRAMES);
        let took = asked.elapsed();
        assert!(took >= Duration::from_millis(300), "{kind}: {took:?}");
    });
}

#[test]
fn the_cameras_of_a_looping_rig_stay_in_step() {
    let root = tempfile::tempdir().expect("a folder");
    let folder = made::rig_dataset(root.path());
    let text = fs::read_to_string(folder.join("frames.jsonl")).expect("text");
    let without_its_last = text.replace(", \"back\": 1557539956.989383", "");
    assert_ne!(without_its_last, text);
    fs::write(folder.join("frames.jsonl"), without_its_last).expect("written");
    let dataset = RigDataset::open(&folder).expect("a dataset");
    let playback = dataset.playback(fast(Repeat::Loop, None));
    let mut stamps = [0, 1].map(|index| {
        let recording = dataset.recording(index).expect("a camera").expect("plays");
        let mut source = Player::new(CAMERA, recording, playback.clone());
        let stamps = (0..3 * FRAMES).map(move |_| next(&mut source).expect("a frame").captured_at);
        stamps.collect::<Vec<_>>().into_iter()
    });
    for at in 0..3 * FRAMES - 3 {
        let front = stamps[0].next().expect("a stamp");
        let back_has_it = at % FRAMES != FRAMES - 1;
        if back_has_it {
            let back = stamps[1].next().expect("a stamp");
            let apart = back.saturating_since(front);
            assert_eq!(apart, Duration::from_millis(50), "frame {at}");
        }
    }
}
