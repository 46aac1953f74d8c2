//! `rosgraph_msgs`: simulated time.

use super::builtin_interfaces::Time;
use serde::{Deserialize, Serialize};

/// What time it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Clock {
    /// Now.
    pub clock: Time,
}
