//! When an object is believed in, and when it is forgotten.

use std::time::Duration;

/// What can be chosen of tracking.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackingOptions {
    /// Frames that must show an object before it is confirmed.
    pub confirm_after: u32,
    /// How long a confirmed object is published after the last frame that showed it.
    pub coast: Duration,
    /// How long cameras must look in vain where an object should be before it is forgotten.
    pub forget_after: Duration,
    /// The same for one that is not confirmed.
    pub doubt_after: Duration,
    /// How long an object is remembered that nobody looks for: hidden, between two views, its camera down.
    pub remember: Duration,
    /// Objects in memory at most; those unseen for the longest go first.
    pub most_objects: usize,
    /// How long slopes of the ground are remembered.
    pub ground_memory: Duration,
}

impl Default for TrackingOptions {
    fn default() -> Self {
        Self {
            // Two false alarms at one place are not rare, three are.
            confirm_after: 3,
            // A planner should not act on longer predictions than this.
            coast: Duration::from_secs(1),
            // Detectors miss a far car for a second or two.
            forget_after: Duration::from_secs(2),
            // A far car is found in every second frame, or less.
            doubt_after: Duration::from_millis(700),
            // A bus that stands before a car, a camera that comes back.
            remember: Duration::from_secs(8),
            most_objects: 1000,
            ground_memory: crate::ByCamera::DEFAULT_GROUND_MEMORY,
        }
    }
}
