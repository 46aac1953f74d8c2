//! Lossless: nothing is dropped, and the same input gives the same output whatever the timing.

mod support;

use roadwatch_core::CameraId;
use roadwatch_pipeline::{Overload, PipelineOptions};
use support::{Got, World, world_with};

/// Camera 0 runs three times as fast as camera 1, and both stamp the same moment once.
fn stamps() -> Vec<(usize, i64)> {
    let fast = (0..30).map(|at| (0, at * 10));
    let slow = (0..10).map(|at| (1, at * 30));
    fast.chain(slow).collect()
}

fn run(max_batch: usize, stamps: &[(usize, i64)]) -> (Vec<Got>, Vec<usize>) {
    let world: World = world_with(
        2,
        PipelineOptions::new(Overload::Wait),
        None,
        (max_batch, Vec::new()),
    );
    for &(camera, stamp) in stamps {
        world.send(camera, stamp);
    }
    let batches = world.batches.clone();
    let (outputs, running) = world.finish();
    for (camera, sent) in [(0, 30), (1, 10)] {
        let counts = running.metrics().camera(CameraId(camera));
        assert_eq!(
            (counts.captured, counts.published, counts.dropped_total()),
            (sent, sent, 0)
        );
    }
    let mut batches = batches.lock().expect("batches").clone();
    batches.sort_unstable();
    (outputs, batches)
}

#[test]
fn frames_come_out_in_order_of_capture_time_and_camera() {
    let (outputs, _) = run(1, &stamps());
    let mut expected = stamps();
    expected.sort_by_key(|&(camera, stamp)| (stamp, camera));
    let frames: Vec<_> = outputs
        .iter()
        .filter_map(|&(camera, stamp)| Some((usize::from(camera?), stamp)))
        .collect();
    assert_eq!(frames, expected);
}

#[test]
fn one_scene_closes_each_round_with_its_newest_stamp() {
    let (outputs, _) = run(1, &stamps());
    let scenes: Vec<_> = outputs
        .iter()
        .filter(|(camera, _)| camera.is_none())
        .map(|got| got.1)
        .collect();
    // Rounds with both cameras end at the slow one's frames; at the end camera 0 goes on alone.
    let together = (0..10).map(|at| at * 30);
    let alone = [280, 290];
    assert_eq!(scenes, together.chain(alone).collect::<Vec<_>>());
}

#[test]
fn the_order_of_arrival_changes_nothing() {
    let mut interleaved = stamps();
    interleaved.sort_by_key(|&(camera, stamp)| (stamp, camera));
    for max_batch in [1, 4] {
        assert_eq!(run(max_batch, &stamps()), run(max_batch, &interleaved));
    }
}

#[test]
fn batches_are_full_until_the_end() {
    let (_, batches) = run(7, &stamps());
    assert_eq!(batches, [5, 7, 7, 7, 7, 7]);
}
