//! One publisher on a topic: what a second one says would be mixed up with it.

use ros2_client::Gid;
use std::time::{Duration, Instant};

/// Another publisher is listened to when the first has been silent for so long.
const SILENCE: Duration = Duration::from_secs(2);

/// The publisher that is listened to, and when it was heard last.
#[derive(Debug, Default)]
pub(super) struct OnePublisher(Option<(Gid, Instant)>);

impl OnePublisher {
    /// Whether what `gid` says counts: it is the one, or the one has gone.
    pub(super) fn admits(&mut self, gid: Gid, now: Instant) -> bool {
        match self.0 {
            Some((known, heard)) if known != gid && now - heard < SILENCE => false,
            _ => {
                self.0 = Some((gid, now));
                true
            }
        }
    }
}
