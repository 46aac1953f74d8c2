//! The clocks of the running system.

use roadwatch_core::{Clock, Timestamp};
use std::time::{Instant, SystemTime, UNIX_EPOCH};

/// The system's monotonic clock.
#[derive(Debug, Clone, Copy, Default)]
pub struct SystemClock;

impl Clock for SystemClock {
    fn now(&self) -> Instant {
        Instant::now()
    }
}

/// Wall-clock time, for the log times of bags.
#[must_use]
#[expect(
    clippy::disallowed_methods,
    reason = "this is the clock that everything else asks"
)]
pub fn wall_time() -> Timestamp {
    let since_epoch = SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .unwrap_or_default();
    Timestamp::from_nanos(i64::try_from(since_epoch.as_nanos()).unwrap_or(i64::MAX))
}
