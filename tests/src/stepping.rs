//! The real pipeline over a world, at realtime pace, one frame at a time as a test says.

use crate::{
    cameras::Release,
    detector::WorldDetector,
    playing::{Memory, Monotonic, PATIENCE, named, stages},
    world::World,
};
use roadwatch_core::{CameraId, Locator, Output, Sink, SinkError};
use roadwatch_pipeline::{Overload, PipelineOptions, Running, start};
use std::{
    sync::{
        Arc,
        mpsc::{Receiver, SyncSender, sync_channel},
    },
    time::Duration,
};

/// Room for everything a test asks for.
const ROOM: usize = 1000;

/// A running pipeline whose cameras wait to be told.
pub struct Stepped {
    running: Running,
    /// By camera.
    signals: Vec<SyncSender<()>>,
    outputs: Receiver<Output>,
}

impl Stepped {
    /// Starts; scenes wait for a silent camera for `scene_timeout`.
    ///
    /// # Panics
    /// When the pipeline does not start.
    #[must_use]
    pub fn start(
        world: &Arc<World>,
        locators: Vec<Box<dyn Locator>>,
        scene_timeout: Duration,
    ) -> Self {
        let cameras = world.scenario().rig.ids();
        let (signals, releases) = cameras
            .map(|_| {
                let (signal, signals) = sync_channel(ROOM);
                (signal, Release::OnSignal(signals))
            })
            .unzip();
        let (sender, outputs) = sync_channel(ROOM);
        let sinks = vec![named("outputs", Outputs(sender))];
        let detector = Arc::new(WorldDetector::new(Arc::clone(world), 1));
        let stages = stages(
            world,
            releases,
            (detector, locators, Memory::left_to_right()),
            sinks,
        );
        let options = PipelineOptions {
            scene_timeout,
            ..PipelineOptions::new(Overload::NewestWins)
        };
        Self {
            running: start(stages, options, Arc::new(Monotonic)).expect("starts"),
            signals,
            outputs,
        }
    }

    /// Lets a camera hand out its next frame.
    ///
    /// # Panics
    /// When the camera has ended.
    pub fn release(&self, camera: CameraId) {
        let signal = &self.signals[camera.index()];
        signal.send(()).expect("the camera lives");
    }

    /// Waits for the next output.
    ///
    /// # Panics
    /// When none comes.
    #[must_use]
    pub fn next_output(&self) -> Output {
        let output = self.outputs.recv_timeout(PATIENCE);
        output.expect("the pipeline goes on")
    }

    /// The pipeline.
    #[must_use]
    pub fn running(&self) -> &Running {
        &self.running
    }
}

impl Drop for Stepped {
    fn drop(&mut self) {
        self.running.stop();
    }
}

struct Outputs(SyncSender<Output>);

impl Sink for Outputs {
    fn publish(&mut self, output: &Output) -> Result<(), SinkError> {
        let sent = self.0.send(output.clone());
        sent.map_err(|error| SinkError::new("nobody listens", error.to_string()))
    }
}
