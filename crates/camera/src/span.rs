//! What a recording covers in time.

use roadwatch_core::Timestamp;
use std::time::Duration;

/// A recording of one frame has no interval of its own: 10 Hz, the usual rate of a recorded rig.
const LONE_FRAME_INTERVAL: Duration = Duration::from_millis(100);

/// The time that one camera's recording covers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Span {
    /// Stamp of the first frame.
    pub first: Timestamp,
    /// Stamp of the last frame; not before `first`.
    pub last: Timestamp,
    /// Mean time between two frames.
    pub interval: Duration,
}

impl Span {
    /// The span of frames with these rising stamps; `None` without any frame. A lone frame counts for 100 ms.
    #[must_use]
    pub fn from_stamps(stamps: impl ExactSizeIterator<Item = Timestamp>) -> Option<Self> {
        let intervals = u32::try_from(stamps.len())
            .unwrap_or(u32::MAX)
            .checked_sub(1)?;
        let (mut first, mut last) = (None, None);
        for stamp in stamps {
            first.get_or_insert(stamp);
            last = Some(stamp);
        }
        let (first, last) = (first?, last?);
        Some(Self {
            first,
            last,
            interval: last
                .saturating_since(first)
                .checked_div(intervals)
                .unwrap_or(LONE_FRAME_INTERVAL),
        })
    }

    /// From the first frame to where the first of a repetition belongs: one mean interval after the last.
    #[must_use]
    pub fn lap(&self) -> Duration {
        self.last.saturating_since(self.first) + self.interval
    }
}
