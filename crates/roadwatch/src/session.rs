//! One run of the pipeline: built from a configuration, watched until it ends.

use crate::{
    clock::SystemClock,
    config::{Changes, Config, EgoConfig, Environment, Mistakes},
    failure::Failure,
    open::{self, Feed},
    switches::Switches,
};
use anyhow::Context as _;
use roadwatch_camera::{DecodeCount, PlaybackOptions};
use roadwatch_core::{EgoMotion, Locator, Rig};
use roadwatch_detect::YoloDetector;
use roadwatch_pipeline::{
    NamedSink, Outcome, PipelineOptions, Running, Stages,
    perceive::{Perceiver, Rotating},
    start,
};
use roadwatch_ros::{EgoListener, RosError, RosNode};
use std::{
    sync::{Arc, atomic::AtomicUsize},
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
    /// What can be changed while it runs.
    pub controls: Controls,
    feeds: Vec<Feed>,
    detector: Arc<YoloDetector>,
    locators: Vec<Box<dyn Locator>>,
    rotation: Option<Rotating>,
    /// Where the vehicle is.
    pub ego: Arc<EgoMotion>,
}

/// What can be changed while it runs.
#[derive(Clone)]
pub struct Controls {
    /// Which detections are kept.
    pub detector: Arc<YoloDetector>,
    /// How many objects of a frame are looked at for headings; `None` where none are.
    pub crops_per_frame: Option<Arc<AtomicUsize>>,
    /// Which cameras are looked at.
    pub switches: Switches,
}

impl Session {
    /// Reads a configuration, with what the command line changes in it, and opens everything it names.
    ///
    /// # Errors
    /// Every mistake at once.
    pub fn open(
        config: &std::path::Path,
        changes: &Changes,
        playback: PlaybackOptions,
    ) -> Result<Self, Mistakes> {
        let config = Config::load(config, changes, &Environment::of_process())?;
        let mut notes = config.notes.clone();
        let decodes = DecodeCount::default();
        let detector = open::detector(&config, &mut notes);
        let locators = open::locators(&config, &mut notes);
        let rotation = open::rotation(&config, &mut notes);
        let ego = open::ego(&config, &mut notes);
        let feeds = open::sources(&config, playback, (&decodes, &ego), &mut notes);
        let rig = open::shared_rig(&config);
        notes.finish()?;
        match (rig, feeds, detector, locators, rotation) {
            (Some(rig), Some(feeds), Some(detector), Some(locators), Ok(rotation)) => {
                let detector = Arc::new(detector);
                let controls = Controls {
                    detector: Arc::clone(&detector),
                    crops_per_frame: rotation.as_ref().map(|r| Arc::clone(&r.crops_per_frame)),
                    switches: Switches::new(&config.enabled),
                };
                Ok(Self {
                    config,
                    rig,
                    decodes,
                    controls,
                    feeds,
                    detector,
                    locators,
                    rotation,
                    ego,
                })
            }
            _ => unreachable!("what could not be opened was noted"),
        }
    }

    /// Whether topics feed cameras, or tell where the vehicle is.
    #[must_use]
    pub fn has_topics(&self) -> bool {
        let is_topic = |feed: &Feed| matches!(feed, Feed::Topic { .. });
        let told = matches!(self.config.ego, EgoConfig::Ros { bag: None, .. });
        told || self.feeds.iter().any(is_topic)
    }

    /// With those cameras listening that topics feed.
    ///
    /// # Errors
    /// When the middleware refuses.
    pub fn listening(mut self, node: &RosNode) -> Result<Self, RosError> {
        let feeds = self.feeds.into_iter().map(|feed| feed.listening(node));
        self.feeds = feeds.collect::<Result<_, _>>()?;
        Ok(self)
    }

    /// Who listens to where the vehicle is, as long as it is kept; `None` where no topic tells.
    ///
    /// # Errors
    /// When the middleware refuses.
    pub fn ego_listener(&self, node: &RosNode) -> Result<Option<EgoListener>, RosError> {
        let EgoConfig::Ros { bag: None, topic } = &self.config.ego else {
            return Ok(None);
        };
        let source = open::ego_source(topic, node.surface());
        EgoListener::listen(node, source, Arc::clone(&self.ego)).map(Some)
    }

    /// Starts the pipeline.
    ///
    /// # Errors
    /// When a camera is fed by a topic and nobody listens, or the system gives no thread.
    pub fn start(
        self,
        sinks: Vec<NamedSink>,
        options: PipelineOptions,
    ) -> Result<Running, Failure> {
        let sources = self.feeds.into_iter().map(|feed| match feed {
            Feed::Playing(source) => Ok(source),
            Feed::Topic { camera, .. } => Err(anyhow::anyhow!(
                "{} is fed by the topic {}, and only a running node can listen to it in real time",
                camera.camera.name,
                camera.images
            )),
        });
        let sources = sources.collect::<Result<Vec<_>, _>>()?;
        let memory = self.config.locate.ground_memory;
        let reidentifier = self.config.reid.reidentifier(&self.rig, memory);
        let stages = Stages {
            sources: self.controls.switches.put_before(sources),
            detector: self.detector,
            perceiver: Perceiver {
                locators: self.locators,
                rotation: self.rotation,
                reidentifier,
                ego: self.ego,
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
