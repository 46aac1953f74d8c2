//! Warnings that repeat are logged at most once in a while, with the number left out.

use std::time::{Duration, Instant};

/// Often enough to notice, seldom enough to read.
const PERIOD: Duration = Duration::from_secs(5);

#[derive(Debug, Default)]
pub(crate) struct WarnLimit {
    last: Option<Instant>,
    suppressed: u64,
}

impl WarnLimit {
    /// The number of warnings left out since the last one logged, when it is time for another; else `None`.
    pub(crate) fn allow(&mut self, now: Instant) -> Option<u64> {
        if self
            .last
            .is_some_and(|last| now.saturating_duration_since(last) < PERIOD)
        {
            self.suppressed += 1;
            return None;
        }
        self.last = Some(now);
        Some(std::mem::take(&mut self.suppressed))
    }
}
