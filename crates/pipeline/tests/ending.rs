//! Stopping, crashing, and cameras that die.

mod support;

use roadwatch_core::{
    CameraId, DetectError, Detection, Detector, Frame, Locator, Output, PerFrame, Sink, SinkError,
};
use roadwatch_pipeline::{
    NamedSink, Outcome, Overload, PipelineError, PipelineOptions, Stages, perceive::Perceiver,
    start,
};
use std::{
    sync::{
        Arc,
        mpsc::{Receiver, SyncSender, sync_channel},
    },
    time::Duration,
};
use support::{
    ChannelSource, NoMemory, Nowhere, PATIENCE, RealClock, gate, gates, world, world_with,
};

#[test]
fn a_stop_drains_what_is_inside_and_finishes_the_sinks() {
    struct Finishing(SyncSender<&'static str>);
    impl Sink for Finishing {
        fn publish(&mut self, _: &Output) -> Result<(), SinkError> {
            self.0
                .send("output")
                .map_err(|error| SinkError::new("gone", error.to_string()))
        }
        fn finish(&mut self) -> Result<(), SinkError> {
            self.0
                .send("finish")
                .map_err(|error| SinkError::new("gone", error.to_string()))
        }
    }
    let (sender, heard) = sync_channel(100);
    let sink = NamedSink {
        name: "finishing".to_owned(),
        sink: Box::new(Finishing(sender)),
    };
    let (gate, arrivals, open) = gate();
    let options = PipelineOptions::new(Overload::NewestWins);
    let world = world_with(1, options, Some(gate), (1, vec![sink]));
    world.send(0, 1);
    arrivals
        .recv_timeout(PATIENCE)
        .expect("the frame reaches the detector");
    world.running.stop();
    drop(open);
    // The cameras' channels are still open: only the stop ends this.
    let outcome = world.running.wait(PATIENCE).expect("no panic");
    assert_eq!(outcome, Outcome::Finished);
    assert_eq!(
        heard.try_iter().collect::<Vec<_>>(),
        ["output", "output", "finish"]
    );
}

#[test]
fn a_detector_that_panics_ends_the_run_with_its_name() {
    struct Panics;
    impl Detector for Panics {
        fn detect(&self, _: Vec<Frame>) -> Vec<Result<PerFrame<Detection>, DetectError>> {
            panic!("a bug")
        }
    }
    let (end, stamps): (_, Receiver<i64>) = sync_channel(10);
    let stages = Stages {
        sources: vec![Box::new(ChannelSource::new(CameraId(0), stamps))],
        detector: Arc::new(Panics),
        perceiver: Perceiver {
            locators: vec![Box::new(Nowhere) as Box<dyn Locator>],
            rotation: None,
            reidentifier: Box::new(NoMemory),
            ego: Arc::default(),
        },
        sinks: Vec::new(),
    };
    let running = start(
        stages,
        PipelineOptions::new(Overload::Wait),
        Arc::new(RealClock),
    )
    .expect("starts");
    for stamp in 0..5 {
        end.send(stamp).expect("room");
    }
    let error = running.wait(PATIENCE).expect_err("a lane panicked");
    assert!(
        matches!(&error, PipelineError::Panicked(name) if name.starts_with("detect")),
        "{error}"
    );
    // The others end by themselves, though the camera never does.
    while running.wait(PATIENCE).is_err() {}
    assert_eq!(running.alive(), Vec::<String>::new());
}

#[test]
fn a_silent_camera_holds_up_no_scene() {
    let options = PipelineOptions {
        scene_timeout: Duration::from_millis(20),
        ..PipelineOptions::new(Overload::NewestWins)
    };
    let world = world_with(2, options, None, (1, Vec::new()));
    world.send(0, 1);
    assert_eq!(world.outputs.recv_timeout(PATIENCE), Ok((Some(0), 1)));
    // Camera 1 is alive and says nothing; the round is closed by timeout.
    assert_eq!(world.outputs.recv_timeout(PATIENCE), Ok((None, 1)));
}

#[test]
fn a_slow_network_does_not_split_a_round() {
    let options = PipelineOptions {
        scene_timeout: Duration::from_millis(5),
        ..PipelineOptions::new(Overload::NewestWins)
    };
    let (gate, arrivals, open) = gates(2);
    let world = world_with(2, options, Some(gate), (1, Vec::new()));
    for camera in 0..2 {
        world.send(camera, 1 + camera as i64);
        arrivals
            .recv_timeout(PATIENCE)
            .expect("the frame reaches the detector");
    }
    open[0].send(()).expect("one passes");
    assert_eq!(world.outputs.recv_timeout(PATIENCE), Ok((Some(0), 1)));
    // Twenty timeouts long the other frame is worked on, and the round stays open.
    assert!(
        world
            .outputs
            .recv_timeout(Duration::from_millis(100))
            .is_err()
    );
    open[1].send(()).expect("the other passes");
    assert_eq!(world.outputs.recv_timeout(PATIENCE), Ok((Some(1), 2)));
    assert_eq!(world.outputs.recv_timeout(PATIENCE), Ok((None, 2)));
}

#[test]
fn cameras_and_locators_must_be_as_many() {
    let world = world(1, Overload::Wait, None);
    let (_, running) = world.finish();
    assert_eq!(running.metrics().scenes(), 0);
    let stages = Stages {
        sources: Vec::new(),
        detector: Arc::new(support::OneBoxDetector {
            gate: None,
            max_batch: 1,
            batches: Arc::default(),
        }),
        perceiver: Perceiver {
            locators: Vec::new(),
            rotation: None,
            reidentifier: Box::new(NoMemory),
            ego: Arc::default(),
        },
        sinks: Vec::new(),
    };
    let started = start(
        stages,
        PipelineOptions::new(Overload::Wait),
        Arc::new(RealClock),
    );
    assert!(matches!(
        started.err(),
        Some(PipelineError::Shape {
            sources: 0,
            locators: 0
        })
    ));
}
