//! Under overload the newest frame wins, every drop is counted, and nobody looks at what is dropped.

mod support;

use roadwatch_core::{CameraId, FrameSource};
use roadwatch_pipeline::{
    DropReason, Edge, NamedSink, Overload, PipelineOptions,
    inbox::{Put, inbox},
};
use std::{
    sync::{Arc, atomic::Ordering, mpsc::sync_channel},
    time::{Duration, Instant},
};
use support::{ChannelSink, ChannelSource, PATIENCE, RealClock, gate, world, world_with};

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

#[test]
fn a_frame_stays_in_its_slot_until_the_detector_can_use_it() {
    let (mut senders, receiver) = inbox(1, Overload::NewestWins, Arc::new(RealClock));
    let sender = senders.remove(0);
    let (stamps, sent) = sync_channel(2);
    let mut source = ChannelSource::new(CameraId(0), sent);
    let mut put = |stamp| {
        stamps.send(stamp).expect("room");
        let frame = source.next_frame(Instant::now() + PATIENCE);
        sender.put(frame.expect("a frame"))
    };
    assert_eq!(put(1), Put::Stored);
    let batch = receiver.take(1, || {
        assert_eq!(put(2), Put::Replaced);
        Duration::from_millis(1)
    });
    let stamps: Vec<_> = batch.expect("a batch").taken;
    assert_eq!(stamps[0].frame.captured_at.as_nanos(), 2);
    assert_eq!(put(3), Put::Stored);
    drop(senders);
    drop(sender);
    // Nothing newer can come, so nobody waits the hour.
    let batch = receiver.take(1, || Duration::from_secs(3600));
    assert_eq!(batch.expect("a batch").taken.len(), 1);
}
