//! The real pipeline over a world, at lossless pace, from the first frame to the last.

use crate::{
    cameras::{Release, WorldCamera},
    detector::WorldDetector,
    world::World,
};
use roadwatch_core::{
    Clock, Detector, EgoMotion, FrameSource, Locator, Output, Reidentifier, Scene, Sink, SinkError,
};
use roadwatch_lab::{Recorded, Recorder};
use roadwatch_pipeline::{
    CameraCounts, NamedSink, Outcome, Overload, PipelineOptions, Stages, perceive::Perceiver, start,
};
use roadwatch_reid::{ByCamera, Rule, Tracker, TrackingOptions};
use std::{
    sync::{Arc, Mutex, PoisonError},
    time::{Duration, Instant},
};

/// Long enough for any machine; only a bug waits this long.
pub const PATIENCE: Duration = Duration::from_secs(30);

/// Everything that was published, in order.
#[derive(Clone, Debug)]
pub struct Played {
    /// Of every camera's frames.
    pub cameras: Vec<Recorded>,
    /// Of the rig.
    pub scenes: Vec<Scene>,
    /// By camera.
    pub counts: Vec<CameraCounts>,
}

/// Time as it passes.
pub(crate) struct Monotonic;

impl Clock for Monotonic {
    fn now(&self) -> Instant {
        Instant::now()
    }
}

/// Plays a world through the pipeline, with one locator per camera and detections in batches of at most
/// `max_batch`.
///
/// # Panics
/// When a thread of the pipeline does, or it does not end.
#[must_use]
pub fn play(world: &Arc<World>, locators: Vec<Box<dyn Locator>>, max_batch: usize) -> Played {
    run(world, locators, max_batch, Memory::left_to_right())
}

/// The same with objects tracked, by someone who knows how the vehicle moves.
///
/// # Panics
/// As [`play`].
#[must_use]
pub fn play_tracked(world: &Arc<World>, locators: Vec<Box<dyn Locator>>) -> Played {
    run(world, locators, 1, Memory::tracks(world))
}

/// Who remembers objects, and what is known of the vehicle.
pub(crate) struct Memory {
    reidentifier: Box<dyn Reidentifier>,
    ego: EgoMotion,
}

impl Memory {
    pub(crate) fn left_to_right() -> Self {
        let ground_memory = ByCamera::DEFAULT_GROUND_MEMORY;
        Self {
            reidentifier: Box::new(ByCamera::new(Rule::LeftToRight, ground_memory)),
            ego: EgoMotion::default(),
        }
    }

    pub(crate) fn tracks(world: &World) -> Self {
        let rig = Arc::new(world.scenario().rig.clone());
        Self {
            reidentifier: Box::new(Tracker::new(rig, TrackingOptions::default())),
            ego: world.ego_motion(),
        }
    }
}

fn run(
    world: &Arc<World>,
    locators: Vec<Box<dyn Locator>>,
    max_batch: usize,
    memory: Memory,
) -> Played {
    let (recorder, scenes) = (Recorder::default(), SceneLog::default());
    let sinks = vec![
        named("recorder", recorder.clone()),
        named("scenes", scenes.clone()),
    ];
    let rig = &world.scenario().rig;
    let releases = rig.ids().map(|_| Release::AtOnce).collect();
    let detector = Arc::new(WorldDetector::new(Arc::clone(world), max_batch));
    let stages = stages(world, releases, (detector, locators, memory), sinks);
    let options = PipelineOptions::new(Overload::Wait);
    let running = start(stages, options, Arc::new(Monotonic)).expect("starts");
    let outcome = running.wait(PATIENCE).expect("no panic");
    assert_eq!(
        outcome,
        Outcome::Finished,
        "still alive: {:?}",
        running.alive()
    );
    Played {
        cameras: recorder.take().frames,
        scenes: scenes.take(),
        counts: rig.ids().map(|id| running.metrics().camera(id)).collect(),
    }
}

pub(crate) fn stages(
    world: &Arc<World>,
    releases: Vec<Release>,
    (detector, locators, memory): (Arc<dyn Detector>, Vec<Box<dyn Locator>>, Memory),
    sinks: Vec<NamedSink>,
) -> Stages {
    let cameras = world.scenario().rig.ids().zip(releases);
    let sources = cameras.map(|(camera, release)| {
        let source = WorldCamera::new(Arc::clone(world), camera, release);
        Box::new(source) as Box<dyn FrameSource>
    });
    Stages {
        sources: sources.collect(),
        detector,
        perceiver: Perceiver {
            locators,
            rotation: None,
            reidentifier: memory.reidentifier,
            ego: Arc::new(memory.ego),
        },
        sinks,
    }
}

pub(crate) fn named(name: &str, sink: impl Sink + 'static) -> NamedSink {
    NamedSink {
        name: name.to_owned(),
        sink: Box::new(sink),
    }
}

/// Keeps scenes. Clones share what is kept.
#[derive(Clone, Debug, Default)]
struct SceneLog(Arc<Mutex<Vec<Scene>>>);

impl SceneLog {
    fn take(&self) -> Vec<Scene> {
        std::mem::take(&mut *self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

impl Sink for SceneLog {
    fn publish(&mut self, output: &Output) -> Result<(), SinkError> {
        if let Output::Scene(scene) = output {
            let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            kept.push(Scene::clone(scene));
        }
        Ok(())
    }
}
