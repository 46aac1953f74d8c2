//! `/clock`: the time that a simulator or a played bag says it is.

use crate::{
    msg::rosgraph_msgs::Clock,
    node::{RosError, RosNode},
};
use roadwatch_core::Timestamp;
use ros2_client::{QosProfile, Subscription, qos::History};
use std::{fmt, sync::Mutex, sync::PoisonError};

/// The newest time that `/clock` gave.
pub struct SimClock {
    subscription: Subscription<Clock>,
    newest: Mutex<Option<Timestamp>>,
}

impl fmt::Debug for SimClock {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "SimClock({:?})", self.newest)
    }
}

impl SimClock {
    /// Listens to `/clock`, as `rclcpp` does: best effort, the newest only (`rclcpp::ClockQoS`).
    ///
    /// # Errors
    /// When the middleware refuses.
    pub fn listen(node: &RosNode) -> Result<Self, RosError> {
        let qos = QosProfile::subscription_default()
            .reliability_best_effort()
            .history(History::KeepLast { depth: 1 });
        Ok(Self {
            subscription: node.subscription("/clock", "rosgraph_msgs/Clock", &qos)?,
            newest: Mutex::new(None),
        })
    }

    /// What time it is; `None` until `/clock` has said so.
    #[must_use]
    pub fn now(&self) -> Option<Timestamp> {
        let mut newest = self.newest.lock().unwrap_or_else(PoisonError::into_inner);
        while let Ok(Some((message, _))) = self.subscription.take() {
            *newest = Some(message.clock.into());
        }
        *newest
    }
}
