//! The real recording of six cameras, where the machine has it.

use roadwatch_camera::{Pace, PlaybackOptions, Player, Repeat, RigDataset};
use roadwatch_core::{CameraId, FrameSource, Rig, SourceError};
use std::io::Write as _;
use std::{
    fs,
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

const SKIPPED: &str = "SKIPPED: pandaset-dev is not here; set ROADWATCH_SHARED to the folder that has data/pandaset-dev";

#[expect(
    clippy::disallowed_methods,
    reason = "a test has no configuration to ask for the recording's place"
)]
fn dataset_folder() -> Option<PathBuf> {
    let repository = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let shared = std::env::var_os("ROADWATCH_SHARED")
        .map_or_else(|| repository.join("../shared"), PathBuf::from);
    let folder = shared.join("data/pandaset-dev");
    folder.is_dir().then_some(folder)
}

/// The digits of a camera's stamp, cut out of the line by hand so that no number parser is trusted.
fn digits_in<'a>(line: &'a str, camera: &str) -> &'a str {
    let key = format!("\"{camera}\": ");
    let (_, after) = line.split_once(&key).expect("the camera's stamp");
    let end = after.find([',', '}']).expect("an end");
    &after[..end]
}

#[test]
fn all_240_frames_play_with_the_digits_of_the_file() {
    let Some(folder) = dataset_folder() else {
        writeln!(std::io::stderr(), "{SKIPPED}").expect("standard error");
        return;
    };
    let dataset = RigDataset::open(&folder).expect("a dataset");
    let rig = Rig::new(dataset.cameras().to_vec(), 0.0).expect("a rig");
    let text = fs::read_to_string(folder.join("frames.jsonl")).expect("text");
    let playback = dataset.playback(PlaybackOptions {
        pace: Pace::AsFastAsPossible,
        repeat: Repeat::Once,
        frame_limit: None,
    });
    let mut played = 0;
    for id in rig.ids() {
        let camera = rig.camera(id);
        let recording = dataset
            .recording(id.index())
            .expect("a camera")
            .expect("plays");
        let mut source = Player::new(id, recording, playback.clone());
        for line in text.lines() {
            let frame = next(&mut source, id);
            let digits = digits_in(line, camera.name.as_str());
            // Display gives nine decimals; the file leaves trailing zeros out.
            let shown = frame.captured_at.to_string();
            assert_eq!(shown.trim_end_matches('0'), digits.trim_end_matches('0'));
            let pixels = frame.image.pixels().expect("decodes");
            assert_eq!(pixels.size(), camera.model.size);
            played += 1;
        }
        let end = source.next_frame(Instant::now());
        assert!(matches!(end, Err(SourceError::EndOfStream)));
    }
    assert_eq!(played, 240);
}

fn next(source: &mut dyn FrameSource, camera: CameraId) -> roadwatch_core::Frame {
    let deadline = Instant::now() + Duration::from_secs(20);
    let frame = source.next_frame(deadline).expect("a frame");
    assert_eq!(frame.camera, camera);
    frame
}
