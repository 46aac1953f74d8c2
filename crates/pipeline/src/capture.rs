//! The body of a camera's thread: frames from the source into the inbox.

use crate::{
    inbox::{Put, Sender},
    metrics::{DropReason, Metrics},
    stop::Stop,
    warn_limit::WarnLimit,
};
use roadwatch_core::{Clock, FrameSource, SourceError, error_chain};
use std::{error::Error, sync::Arc, time::Duration};

/// How often a waiting source looks up, so that a stop takes effect.
const READ_TIMEOUT: Duration = Duration::from_millis(100);
/// First pause before a lost camera is tried again; doubles with each failure.
const FIRST_RETRY: Duration = Duration::from_millis(100);
/// Longest such pause: a camera that comes back is seen within this time.
const LONGEST_RETRY: Duration = Duration::from_secs(5);

pub(crate) struct Capture {
    pub(crate) source: Box<dyn FrameSource>,
    pub(crate) inbox: Sender,
    pub(crate) metrics: Arc<Metrics>,
    pub(crate) clock: Arc<dyn Clock>,
    pub(crate) stop: Stop,
}

impl Capture {
    /// Runs until the recording ends, the stop is requested, or nobody takes frames any more.
    pub(crate) fn run(mut self) {
        let camera = self.inbox.camera();
        let mut retry = FIRST_RETRY;
        let mut warnings = WarnLimit::default();
        while !self.stop.is_requested() {
            match self.source.next_frame(self.clock.now() + READ_TIMEOUT) {
                Ok(frame) => {
                    retry = FIRST_RETRY;
                    self.metrics.captured(camera);
                    match self.inbox.put(frame) {
                        Put::Stored => {}
                        Put::Replaced => self.metrics.dropped(camera, DropReason::Replaced),
                        Put::Closed => {
                            self.metrics.dropped(camera, DropReason::Closed);
                            return;
                        }
                    }
                }
                Err(SourceError::Timeout) => {}
                Err(SourceError::EndOfStream) => return,
                Err(SourceError::FrameLost(cause)) => {
                    self.metrics.lost(camera);
                    self.warn(&mut warnings, "frame lost in the source", cause.as_ref());
                }
                Err(SourceError::Disconnected(cause)) => {
                    self.metrics.disconnected(camera);
                    self.warn(
                        &mut warnings,
                        "camera disconnected, trying again",
                        cause.as_ref(),
                    );
                    self.stop.wait(retry);
                    retry = (retry * 2).min(LONGEST_RETRY);
                }
            }
        }
    }

    fn warn(&self, warnings: &mut WarnLimit, what: &str, cause: &(dyn Error + 'static)) {
        if let Some(suppressed) = warnings.allow(self.clock.now()) {
            tracing::warn!(
                camera = self.inbox.camera().0,
                error = error_chain(cause),
                suppressed,
                "{what}"
            );
        }
    }
}
