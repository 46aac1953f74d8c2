//! The threads of a pipeline, and the handle of what runs.

use crate::{metrics::Metrics, start::PipelineError, stop::Stop};
use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    sync::{
        Arc, Mutex, PoisonError,
        mpsc::{Receiver, SyncSender, sync_channel},
    },
    thread,
    time::{Duration, Instant},
};

/// Whether a pipeline is still at work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// Some thread still runs.
    Running,
    /// Every thread has ended.
    Finished,
}

/// A started pipeline.
pub struct Running {
    metrics: Arc<Metrics>,
    stop: Stop,
    ended: Mutex<Receiver<Ended>>,
    alive: Mutex<Vec<String>>,
}

struct Ended {
    name: String,
    panicked: bool,
}

/// Starts named threads and hears of their ends.
pub(crate) struct Threads {
    ended: SyncSender<Ended>,
    ends: Receiver<Ended>,
    names: Vec<String>,
}

impl Threads {
    pub(crate) fn new(count: usize) -> Self {
        let (ended, ends) = sync_channel(count);
        Self {
            ended,
            ends,
            names: Vec::new(),
        }
    }

    pub(crate) fn spawn(
        &mut self,
        name: String,
        body: impl FnOnce() + Send + 'static,
    ) -> Result<(), PipelineError> {
        let ended = self.ended.clone();
        let report = name.clone();
        let run = move || {
            let panicked = catch_unwind(AssertUnwindSafe(body)).is_err();
            // The channel has room for every thread; it is gone only when nobody wants to know.
            ended
                .send(Ended {
                    name: report,
                    panicked,
                })
                .ok();
        };
        thread::Builder::new()
            .name(name.clone())
            .spawn(run)
            .map_err(|cause| PipelineError::Spawn {
                name: name.clone(),
                cause,
            })?;
        self.names.push(name);
        Ok(())
    }

    pub(crate) fn into_running(self, metrics: Arc<Metrics>, stop: Stop) -> Running {
        Running {
            metrics,
            stop,
            ended: Mutex::new(self.ends),
            alive: Mutex::new(self.names),
        }
    }
}

impl Running {
    /// Counts and latencies, live.
    #[must_use]
    pub fn metrics(&self) -> &Metrics {
        &self.metrics
    }

    /// Asks the sources to stop; what is inside is still worked off, in order.
    pub fn stop(&self) {
        self.stop.request();
    }

    /// Names of the threads that still run.
    #[must_use]
    pub fn alive(&self) -> Vec<String> {
        self.alive
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clone()
    }

    /// Waits for the end, at most for `timeout`.
    ///
    /// # Errors
    /// When a thread panicked; the others are then asked to stop.
    pub fn wait(&self, timeout: Duration) -> Result<Outcome, PipelineError> {
        let ended = self.ended.lock().unwrap_or_else(PoisonError::into_inner);
        let deadline = Instant::now() + timeout;
        loop {
            if self.alive().is_empty() {
                return Ok(Outcome::Finished);
            }
            let left = deadline.saturating_duration_since(Instant::now());
            let Ok(Ended { name, panicked }) = ended.recv_timeout(left) else {
                return Ok(Outcome::Running);
            };
            self.alive
                .lock()
                .unwrap_or_else(PoisonError::into_inner)
                .retain(|alive| *alive != name);
            if panicked {
                self.stop();
                return Err(PipelineError::Panicked(name));
            }
        }
    }
}
