//! The topology on one screen.

use crate::{
    capture::Capture,
    detecting::{LANES, Lane, Seen, Turnstile},
    inbox::{Receiver, Sender, inbox},
    metrics::Metrics,
    options::{Overload, PipelineOptions},
    perceive::Perceiver,
    perceiving::Perceiving,
    round::RoundAssembler,
    running::{Running, Threads},
    sinking::{Fanout, Sinking},
    stop::Stop,
    warn_limit::WarnLimit,
};
use roadwatch_core::{Clock, Detector, FrameSource, Sink};
use std::{
    io,
    sync::{
        Arc, Weak,
        mpsc::{SyncSender, sync_channel},
    },
};

/// Frames between detection and perceiving: perceiving is far faster, so one per lane is plenty.
pub const DETECTED_QUEUE_LEN: usize = LANES;

/// A sink with the name it has in metrics and logs.
pub struct NamedSink {
    /// A short name, such as `ros2` or `bag`.
    pub name: String,
    /// The sink.
    pub sink: Box<dyn Sink>,
}

/// Everything a pipeline is made of, built and checked.
pub struct Stages {
    /// One per camera, in order of their ids.
    pub sources: Vec<Box<dyn FrameSource>>,
    /// Shared by all cameras.
    pub detector: Arc<dyn Detector>,
    /// Locators (one per source), headings and memory.
    pub perceiver: Perceiver,
    /// Where outputs go.
    pub sinks: Vec<NamedSink>,
}

/// The pipeline did not start, or did not end as it should.
#[derive(Debug, thiserror::Error)]
pub enum PipelineError {
    /// The number of sources is zero, over 255, or not that of the locators.
    #[error("{sources} sources and {locators} locators do not make a pipeline")]
    Shape {
        /// Number of sources.
        sources: usize,
        /// Number of locators.
        locators: usize,
    },
    /// The system gave no thread.
    #[error("cannot start thread `{name}`")]
    Spawn {
        /// The thread.
        name: String,
        /// Why.
        #[source]
        cause: io::Error,
    },
    /// A stage panicked: a bug.
    #[error("thread `{0}` panicked")]
    Panicked(String),
}

/// Starts every stage on its thread.
///
/// # Errors
/// When the stages do not fit together, or the system gives no thread.
pub fn start(
    stages: Stages,
    options: PipelineOptions,
    clock: Arc<dyn Clock>,
) -> Result<Running, PipelineError> {
    let Stages {
        sources,
        detector,
        perceiver,
        sinks,
    } = stages;
    let shape = PipelineError::Shape {
        sources: sources.len(),
        locators: perceiver.locators.len(),
    };
    let cameras = match u8::try_from(sources.len()) {
        Ok(cameras @ 1..) if sources.len() == perceiver.locators.len() => cameras,
        _ => return Err(shape),
    };
    let names: Vec<_> = sinks.iter().map(|sink| sink.name.clone()).collect();
    let metrics = Arc::new(Metrics::new(sources.len(), &names).ok_or(shape)?);
    let mut starting = Starting {
        threads: Threads::new(sources.len() + LANES + 1 + sinks.len()),
        metrics: Arc::clone(&metrics),
        clock: Arc::clone(&clock),
        stop: Stop::default(),
        options,
    };
    // From the end to the start, so that each stage finds its outbox.
    let fanout = starting.sinks(sinks)?;
    let (senders, inbox) = inbox(cameras, options.overload, clock);
    let inbox = Arc::new(inbox);
    let detected = starting.perceiving(perceiver, fanout, Arc::downgrade(&inbox))?;
    starting.lanes(inbox, &detector, &detected)?;
    starting.cameras(sources, senders)?;
    Ok(starting.threads.into_running(metrics, starting.stop))
}

/// What every thread is given.
struct Starting {
    threads: Threads,
    metrics: Arc<Metrics>,
    clock: Arc<dyn Clock>,
    stop: Stop,
    options: PipelineOptions,
}

impl Starting {
    fn sinks(&mut self, sinks: Vec<NamedSink>) -> Result<Fanout, PipelineError> {
        let mut queues = Vec::new();
        for (at, NamedSink { name, sink }) in sinks.into_iter().enumerate() {
            let (queue, inbox) = sync_channel(self.options.sink_queue_len.max(1));
            queues.push(queue);
            let sinking = Sinking {
                at,
                name: name.clone(),
                sink,
                inbox,
                metrics: Arc::clone(&self.metrics),
                clock: Arc::clone(&self.clock),
            };
            self.threads
                .spawn(format!("sink {name}"), move || sinking.run())?;
        }
        Ok(Fanout {
            queues,
            overload: self.options.overload,
            metrics: Arc::clone(&self.metrics),
        })
    }

    fn perceiving(
        &mut self,
        perceiver: Perceiver,
        fanout: Fanout,
        inbox: Weak<Receiver>,
    ) -> Result<SyncSender<Seen>, PipelineError> {
        let (detected, detections) = sync_channel(DETECTED_QUEUE_LEN);
        let step = Perceiving {
            perceiver,
            inbox,
            rounds: RoundAssembler::new(match self.options.overload {
                Overload::NewestWins => Some(self.options.scene_timeout),
                Overload::Wait => None,
            }),
            fanout,
            metrics: Arc::clone(&self.metrics),
            clock: Arc::clone(&self.clock),
            warnings: WarnLimit::default(),
        };
        self.threads
            .spawn("perceive".to_owned(), move || step.run(&detections))?;
        Ok(detected)
    }

    fn lanes(
        &mut self,
        inbox: Arc<Receiver>,
        detector: &Arc<dyn Detector>,
        detected: &SyncSender<Seen>,
    ) -> Result<(), PipelineError> {
        let turnstile = Arc::new(Turnstile::default());
        for number in 0..LANES {
            let lane = Lane {
                inbox: Arc::clone(&inbox),
                detector: Arc::clone(detector),
                turnstile: Arc::clone(&turnstile),
                out: detected.clone(),
                metrics: Arc::clone(&self.metrics),
                clock: Arc::clone(&self.clock),
            };
            self.threads
                .spawn(format!("detect {number}"), move || lane.run())?;
        }
        Ok(())
    }

    fn cameras(
        &mut self,
        sources: Vec<Box<dyn FrameSource>>,
        senders: Vec<Sender>,
    ) -> Result<(), PipelineError> {
        for (source, inbox) in sources.into_iter().zip(senders) {
            let capture = Capture {
                source,
                inbox,
                metrics: Arc::clone(&self.metrics),
                clock: Arc::clone(&self.clock),
                stop: self.stop.clone(),
            };
            let name = format!("camera {}", capture.inbox.camera().0);
            self.threads.spawn(name, move || capture.run())?;
        }
        Ok(())
    }
}
