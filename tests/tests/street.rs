//! Six cameras in traffic, everything going wrong at once.

use roadwatch_core::CameraId;
use roadwatch_lab::TruthFilter;
use roadwatch_locate::LocationTable;
use roadwatch_tests::{Imperfections, MountError, Played, World, play, scenes::street, score};
use std::sync::{Arc, LazyLock};

const FRAMES: u64 = 40;

fn everything_wrong(seed: u64) -> Imperfections {
    Imperfections {
        seed,
        dropout_share: 0.1,
        jitter_px: 1.5,
        false_alarm_share: 0.1,
        missing_share: 0.05,
        mount: MountError {
            pitch_deg: 0.2,
            yaw_deg: -0.2,
            roll_deg: 0.3,
            up_m: 0.02,
        },
        blind: None,
    }
}

/// Of the rig as it is believed to be: what goes wrong does not change them.
static TABLES: LazyLock<Vec<LocationTable>> =
    LazyLock::new(|| World::new(street(0), Imperfections::default()).tables());

fn play_in(world: &Arc<World>, max_batch: usize) -> Played {
    play(world, world.table_locators(&TABLES), max_batch)
}

fn play_street(seed: u64, max_batch: usize) -> Played {
    let world = World::new(street(FRAMES), everything_wrong(seed));
    play_in(&world, max_batch)
}

/// All that was published but when it was, as text: every number with all its digits.
fn text(played: &Played) -> String {
    format!("{:?}\n{:?}", played.cameras, played.scenes)
}

#[test]
fn played_twice_everything_is_the_same_and_with_another_seed_it_is_not() {
    let (once, again) = (play_street(1, 1), play_street(1, 1));
    assert_eq!(text(&once), text(&again));
    assert_eq!(once.counts, again.counts);
    assert_ne!(text(&once), text(&play_street(2, 1)));
}

#[test]
fn the_size_of_batches_changes_nothing() {
    assert_eq!(text(&play_street(1, 1)), text(&play_street(1, 4)));
}

#[test]
fn every_frame_that_was_not_lost_is_published_in_order() {
    let played = play_street(1, 1);
    for counts in &played.counts {
        assert_eq!(counts.captured + counts.lost, FRAMES);
        assert_eq!(counts.captured, counts.published);
    }
    let order: Vec<_> = played
        .cameras
        .iter()
        .map(|frame| (frame.captured_at, frame.camera))
        .collect();
    assert!(order.is_sorted());
    let stamps: Vec<_> = played.scenes.iter().map(|scene| scene.stamp).collect();
    assert!(stamps.is_sorted());
    // A round takes each camera's next frame: a camera that lost one is ahead, and its newer frame stands for both.
    let least = played.counts.iter().map(|counts| counts.captured).min();
    let (scenes, least) = (stamps.len() as u64, least.expect("six cameras"));
    println!("{scenes} scenes, {least} frames of the camera with the fewest");
    assert!((least - 3..=FRAMES).contains(&scenes), "{scenes}");
}

#[test]
fn well_seen_cars_are_found_and_placed_by_every_camera() {
    let world = World::new(street(FRAMES), Imperfections::default());
    let played = play_in(&world, 1);
    let report = score(&world, &played, &TruthFilter::default());
    println!("{}", report.summary());
    assert_eq!(report.frames, 6 * FRAMES as usize);
    assert!(report.detection.n > 500, "{}", report.detection.n);
    assert_eq!(report.detection.precision, Some(1.0));
    assert!(report.detection.recall.is_some_and(|recall| recall > 0.98));
    let location = report.published.location;
    assert_eq!(location.n, report.detection.matched);
    assert!(location.p90_m.is_some_and(|p90_m| p90_m < 1.6));
    for camera in 0..6 {
        let mut frames = played.cameras.iter();
        let sees = frames.any(|frame| frame.camera == CameraId(camera) && !frame.tracks.is_empty());
        assert!(sees, "camera {camera} sees nobody");
    }
}

#[test]
fn everything_wrong_at_once_costs_accuracy_and_breaks_nothing() {
    let world = World::new(street(FRAMES), everything_wrong(1));
    let played = play_in(&world, 1);
    let report = score(&world, &played, &TruthFilter::default());
    println!("{}", report.summary());
    assert!(
        report
            .detection
            .recall
            .is_some_and(|recall| (0.75..0.92).contains(&recall))
    );
    assert!(
        report
            .detection
            .precision
            .is_some_and(|precision| precision > 0.85)
    );
    assert!(
        report
            .published
            .location
            .p90_m
            .is_some_and(|p90_m| p90_m < 8.0)
    );
}
