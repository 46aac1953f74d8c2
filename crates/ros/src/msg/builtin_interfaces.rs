//! `builtin_interfaces`: moments and lengths of time.

use roadwatch_core::Timestamp;
use serde::{Deserialize, Serialize};

/// A moment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Time {
    /// Whole seconds since the Unix epoch.
    pub sec: i32,
    /// Nanoseconds past `sec`.
    pub nanosec: u32,
}

impl From<Timestamp> for Time {
    /// Exact from 1901 to 2038, what 32-bit seconds can say; clamped to that span outside.
    fn from(stamp: Timestamp) -> Self {
        let clamped = stamp.secs().clamp(i64::from(i32::MIN), i64::from(i32::MAX));
        Self {
            sec: clamped as i32,
            nanosec: stamp.subsec_nanos(),
        }
    }
}

impl From<Time> for Timestamp {
    fn from(time: Time) -> Self {
        let nanos = i64::from(time.sec) * 1_000_000_000 + i64::from(time.nanosec);
        Self::from_nanos(nanos)
    }
}

/// A length of time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Duration {
    /// Whole seconds.
    pub sec: i32,
    /// Nanoseconds past `sec`.
    pub nanosec: u32,
}
