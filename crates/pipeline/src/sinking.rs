//! Sinks: a thread and a bounded queue each, so that none slows perception or another.

use crate::{metrics::Metrics, options::Overload, warn_limit::WarnLimit};
use roadwatch_core::{Clock, Output, Sink, error_chain};
use std::{
    sync::{
        Arc,
        mpsc::{Receiver, SyncSender, TrySendError},
    },
    time::Instant,
};

/// An output on its way, with the moment its frame was received (`None` for scenes).
pub(crate) type Queued = (Output, Option<Instant>);

/// The sending ends of all sinks.
pub(crate) struct Fanout {
    pub(crate) queues: Vec<SyncSender<Queued>>,
    pub(crate) overload: Overload,
    pub(crate) metrics: Arc<Metrics>,
}

impl Fanout {
    pub(crate) fn send(&self, output: &Output, received_at: Option<Instant>) {
        for (at, queue) in self.queues.iter().enumerate() {
            let queued = (output.clone(), received_at);
            let dropped = match self.overload {
                Overload::Wait => queue.send(queued).is_err(),
                Overload::NewestWins => match queue.try_send(queued) {
                    Ok(()) => false,
                    Err(TrySendError::Full(_) | TrySendError::Disconnected(_)) => true,
                },
            };
            if dropped {
                self.metrics.sink_dropped(at);
            }
        }
    }
}

pub(crate) struct Sinking {
    pub(crate) at: usize,
    pub(crate) name: String,
    pub(crate) sink: Box<dyn Sink>,
    pub(crate) inbox: Receiver<Queued>,
    pub(crate) metrics: Arc<Metrics>,
    pub(crate) clock: Arc<dyn Clock>,
}

impl Sinking {
    /// Runs until the queue is closed and empty, then finishes the sink.
    pub(crate) fn run(mut self) {
        let mut warnings = WarnLimit::default();
        while let Ok((output, received_at)) = self.inbox.recv() {
            match self.sink.publish(&output) {
                Ok(()) => {
                    let now = self.clock.now();
                    let latency = received_at.map(|at| now.saturating_duration_since(at));
                    self.metrics.delivered(self.at, latency);
                }
                Err(error) => {
                    self.metrics.sink_failed(self.at);
                    if let Some(suppressed) = warnings.allow(self.clock.now()) {
                        let cause = error_chain(&error);
                        tracing::warn!(sink = self.name, error = cause, suppressed, "output lost");
                    }
                }
            }
        }
        if let Err(error) = self.sink.finish() {
            self.metrics.sink_failed(self.at);
            tracing::error!(
                sink = self.name,
                error = error_chain(&error),
                "sink not finished"
            );
        }
    }
}
