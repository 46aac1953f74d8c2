//! `/parameter_events`: tells of parameters that were set.

use crate::node::{Outlet, RosError, RosNode, reliable};
use roadwatch_core::Timestamp;
use ros2_client::{ParameterValue, builtin_interfaces::Time, parameters::raw};
use std::{
    fmt,
    sync::{Arc, OnceLock},
};

type Now = Box<dyn Fn() -> Timestamp + Send + Sync>;

/// Messages kept for slow readers (`rmw_qos_profile_parameter_events`).
const EVENT_DEPTH: usize = 1000;

/// Tells of parameters that were set, on `/parameter_events`. Silent until it is announced.
#[derive(Clone, Default)]
pub struct ParameterEvents(Arc<OnceLock<Announced>>);

struct Announced {
    outlet: Outlet<raw::ParameterEvent>,
    node: String,
    now: Now,
}

impl fmt::Debug for ParameterEvents {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "ParameterEvents(announced: {})", self.0.get().is_some())
    }
}

impl ParameterEvents {
    /// Announces the topic; `now` gives the events' stamps. Once is enough.
    ///
    /// # Errors
    /// When the middleware refuses.
    pub fn announce(
        &self,
        node: &RosNode,
        now: impl Fn() -> Timestamp + Send + Sync + 'static,
    ) -> Result<(), RosError> {
        let qos = reliable(EVENT_DEPTH);
        let outlet = node.outlet("/parameter_events", "rcl_interfaces/ParameterEvent", &qos)?;
        let node = node.surface().private_prefix();
        let now = Box::new(now);
        self.0.get_or_init(|| Announced { outlet, node, now });
        Ok(())
    }

    /// Tells that a parameter has another value.
    pub fn changed(&self, name: &str, value: ParameterValue) {
        let Some(announced) = self.0.get() else {
            return;
        };
        let changed = raw::Parameter {
            name: name.to_owned(),
            value: value.into(),
        };
        let event = raw::ParameterEvent {
            stamp: Time::from_nanos((announced.now)().as_nanos()),
            node: announced.node.clone(),
            new_parameters: Vec::new(),
            changed_parameters: vec![changed],
            deleted_parameters: Vec::new(),
        };
        if let Err(error) = announced.outlet.publish(event) {
            tracing::warn!(error, "not published on /parameter_events");
        }
    }
}
