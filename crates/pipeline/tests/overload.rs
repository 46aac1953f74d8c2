//! Under overload the newest frame wins, every drop is counted, and nobody looks at what is dropped.

mod support;

use roadwatch_core::CameraId;
use roadwatch_pipeline::{DropReason, Edge, NamedSink, Overload, PipelineOptions};
use std::sync::{atomic::Ordering, mpsc::sync_channel};
use support::{ChannelSink, PATIENCE, gate, world, world_with};

#[test]
fn a_busy_detector_gets_the_newest_frame_and_the_others_are_never_decoded() {
    let (gate, arrivals, open) = gate();
    let world = world(1, Overload::NewestWins, Some(gate));
    // Two frames occupy both lanes, so the next eight meet in the slot.
    for stamp in 0..2 {
        world.send(0, stamp);
        arrivals
            .recv_timeout(PATIENCE)
            .expect("the frame reaches the detector");
    }
    for stamp in 2..10 {
        world.send(0, stamp);
    }
    world.wait_captured(0, 10);
    world.wait_until(|running| running.metrics().camera(CameraId(0)).dropped_total() == 7);
    drop(open);
    let decodes = world.decodes.clone();
    let (outputs, running) = world.finish();
    let published: Vec<_> = outputs
        .iter()
        .filter(|(camera, _)| camera.is_some())
        .map(|got| got.1)
        .collect();
    assert_eq!(published, [0, 1, 9]);
    let counts = running.metrics().camera(CameraId(0));
    assert_eq!((counts.captured, counts.published), (10, 3));
    assert_eq!(counts.dropped[DropReason::Replaced as usize], 7);
    assert_eq!(decodes.load(Ordering::SeqCst), 3);
    assert_eq!(running.metrics().edge(Edge::ReceivedToPerceived).count, 3);
}

#[test]
fn the_camera_that_waited_longest_goes_first() {
    let (gate, arrivals, open) = gate();
    let world = world(3, Overload::NewestWins, Some(gate));
    for camera in [2, 1] {
        world.send(camera, camera as i64);
        arrivals
            .recv_timeout(PATIENCE)
            .expect("the frame reaches the detector");
    }
    for camera in 0..3 {
        world.send(camera, 10 + camera as i64);
    }
    for (camera, count) in [(0, 1), (1, 2), (2, 2)] {
        world.wait_captured(camera, count);
    }
    drop(open);
    let (outputs, _) = world.finish();
    let order: Vec<_> = outputs
        .iter()
        .filter_map(|&(camera, stamp)| camera.map(|_| stamp))
        .collect();
    // Camera 0 was never served; camera 2 was served before camera 1.
    assert_eq!(order, [2, 1, 10, 12, 11]);
}

#[test]
fn a_sink_that_hangs_loses_its_outputs_and_holds_up_nobody() {
    let (stuck, unstick) = sync_channel(0);
    let hanging = NamedSink {
        name: "hanging".to_owned(),
        sink: Box::new(ChannelSink(stuck)),
    };
    let options = PipelineOptions {
        sink_queue_len: 2,
        ..PipelineOptions::new(Overload::NewestWins)
    };
    let world = world_with(1, options, None, (1, vec![hanging]));
    for stamp in 0..20 {
        world.send(0, stamp);
        let (camera, got) = world
            .outputs
            .recv_timeout(PATIENCE)
            .expect("the other sink is served");
        assert_eq!((camera, got), (Some(0), stamp));
        let (camera, _) = world
            .outputs
            .recv_timeout(PATIENCE)
            .expect("its scene follows");
        assert_eq!(camera, None);
    }
    drop(unstick);
    let (_, running) = world.finish();
    let counts = running.metrics().sink(1);
    // One output is in its hands and two wait.
    assert_eq!(counts.dropped, 37);
    assert_eq!(counts.delivered + counts.failed, 3);
    assert_eq!(running.metrics().sink(0).delivered, 40);
}
