//! One run of the pipeline: built from a configuration, watched until it ends.

use crate::{
    clock::{SystemClock, wall_time},
    config::{Config, DatasetChoice, Environment, Mistakes},
    failure::Failure,
    open,
};
use anyhow::Context as _;
use roadwatch_camera::{DecodeCount, PlaybackOptions};
use roadwatch_core::{Detector, FrameSource, Locator, Rig};
use roadwatch_pipeline::{
    NamedSink, Outcome, PipelineOptions, Running, Stages,
    perceive::{Perceiver, Rotating},
    start,
};
use roadwatch_reid::LeftToRight;
use roadwatch_ros::RosArgs;
use std::{
    sync::Arc,
    time::{Duration, Instant},
};

/// How long the pipeline may take to work off what is inside after a stop.
const DRAIN_TIMEOUT: Duration = Duration::from_secs(10);

/// Everything opened and checked; nothing runs yet.
pub struct Session {
    /// The configuration.
    pub config: Config,
    /// The rig.
    pub rig: Arc<Rig>,
    /// Counts the images that are decoded.
    pub decodes: DecodeCount,
    sources: Vec<Box<dyn FrameSource>>,
    detector: Arc<dyn Detector>,
    locators: Vec<Box<dyn Locator>>,
    rotation: Option<Rotating>,
}

impl Session {
    /// Reads a configuration and opens everything it names.
    ///
    /// # Errors
    /// Every mistake at once.
    pub fn open(
        config: &std::path::Path,
        dataset: Option<DatasetChoice>,
        playback: PlaybackOptions,
    ) -> Result<Self, Mistakes> {
        let config = Config::load(config, dataset, &Environment::of_process())?;
        let mut notes = config.notes.clone();
        let decodes = DecodeCount::default();
        let detector = open::detector(&config, &mut notes);
        let locators = open::locators(&config, &mut notes);
        let rotation = open::rotation(&config, &mut notes);
        let sources = open::sources(&config, playback, &decodes, &mut notes);
        let rig = open::shared_rig(&config);
        notes.finish()?;
        match (rig, sources, detector, locators, rotation) {
            (Some(rig), Some(sources), Some(detector), Some(locators), Ok(rotation)) => Ok(Self {
                config,
                rig,
                decodes,
                sources,
                detector: Arc::new(detector),
                locators,
                rotation,
            }),
            _ => unreachable!("what could not be opened was noted"),
        }
    }

    /// Under the names that somebody asked for behind `--ros-args`.
    #[must_use]
    pub fn renamed(mut self, args: &RosArgs) -> Self {
        let surface = &mut self.config.node.options.surface;
        *surface = surface.renamed(args);
        self
    }

    /// Starts the pipeline.
    ///
    /// # Errors
    /// When the system gives no thread.
    pub fn start(
        self,
        sinks: Vec<NamedSink>,
        options: PipelineOptions,
    ) -> Result<Running, Failure> {
        let stages = Stages {
            sources: self.sources,
            detector: self.detector,
            perceiver: Perceiver {
                locators: self.locators,
                rotation: self.rotation,
                reidentifier: Box::new(LeftToRight::new(self.config.locate.ground_memory)),
            },
            sinks,
        };
        let running = start(stages, options, Arc::new(SystemClock));
        Ok(running.context("the pipeline cannot be started")?)
    }
}

/// Watches a pipeline until it ends, calling `report` about once per `period`; `stop_requested` is asked
/// in between.
///
/// # Errors
/// When a stage panicked, or what is inside is not worked off within ten seconds of a stop.
pub fn watch(
    running: &Running,
    period: Duration,
    stop_requested: impl Fn() -> bool,
    mut report: impl FnMut(&Running),
) -> Result<(), Failure> {
    /// How soon a stop is noticed.
    const LOOK: Duration = Duration::from_millis(50);
    let mut next_report = Instant::now() + period;
    let mut drain_until = None;
    loop {
        let outcome = match running.wait(LOOK) {
            Ok(outcome) => outcome,
            Err(panicked) => {
                // The other stages were told to stop; what they hold, a recording above all, is finished.
                drain(running);
                return Err(anyhow::Error::new(panicked)
                    .context("a bug in a stage ended the run")
                    .into());
            }
        };
        if outcome == Outcome::Finished {
            return Ok(());
        }
        if Instant::now() >= next_report {
            next_report += period;
            report(running);
        }
        match drain_until {
            None if stop_requested() => {
                running.stop();
                drain_until = Some(Instant::now() + DRAIN_TIMEOUT);
            }
            Some(until) if Instant::now() >= until => {
                let alive = running.alive().join(", ");
                let error = anyhow::anyhow!("still busy 10 s after the stop: {alive}");
                return Err(Failure::Other(error));
            }
            _ => {}
        }
    }
}

/// Waits for the rest of a pipeline in which a stage panicked.
fn drain(running: &Running) {
    let until = Instant::now() + DRAIN_TIMEOUT;
    while Instant::now() < until && !running.alive().is_empty() {
        if let Err(panicked) = running.wait(DRAIN_TIMEOUT) {
            tracing::error!(error = %panicked, "another stage ended by a bug");
        }
    }
}

/// The stamp of messages that belong to no frame.
#[must_use]
pub fn start_stamp() -> roadwatch_core::Timestamp {
    wall_time()
}
