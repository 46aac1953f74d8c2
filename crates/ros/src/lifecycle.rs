//! The node as a managed one (ROS 2 design, "Managed nodes"): a stack can hold it back, start it, pause it.

use crate::{
    msg::lifecycle_msgs::{
        AvailableStates, AvailableTransitions, ChangeStateRequest, ChangeStateResponse,
        CurrentState, NoFields, State, Transition, TransitionDescription, TransitionEvent,
    },
    node::{Outlet, RosError, RosNode, Service, reliable},
};
use std::{
    fmt,
    sync::{Arc, Mutex, OnceLock, PoisonError},
};

/// A primary state, by the number ROS gives it (`lifecycle_msgs/State`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Nothing is published.
    Unconfigured = 1,
    /// Ready, and nothing is published.
    Inactive = 2,
    /// At work.
    Active = 3,
    /// About to end.
    Finalized = 4,
}

impl Phase {
    const ALL: [Self; 4] = [
        Self::Unconfigured,
        Self::Inactive,
        Self::Active,
        Self::Finalized,
    ];

    fn as_state(self) -> State {
        let label = match self {
            Self::Unconfigured => "unconfigured",
            Self::Inactive => "inactive",
            Self::Active => "active",
            Self::Finalized => "finalized",
        };
        State {
            id: self as u8,
            label: label.to_owned(),
        }
    }
}

/// One of the transitions that somebody may ask for: number, name, from, to (`lifecycle_msgs/Transition`).
#[derive(Clone, Copy)]
struct Step(u8, &'static str, Phase, Phase);

const STEPS: [Step; 7] = [
    Step(1, "configure", Phase::Unconfigured, Phase::Inactive),
    Step(2, "cleanup", Phase::Inactive, Phase::Unconfigured),
    Step(3, "activate", Phase::Inactive, Phase::Active),
    Step(4, "deactivate", Phase::Active, Phase::Inactive),
    Step(5, "shutdown", Phase::Unconfigured, Phase::Finalized),
    Step(6, "shutdown", Phase::Inactive, Phase::Finalized),
    Step(7, "shutdown", Phase::Active, Phase::Finalized),
];

impl Step {
    fn transition(self) -> Transition {
        Transition {
            id: self.0,
            label: self.1.to_owned(),
        }
    }

    fn description(self) -> TransitionDescription {
        TransitionDescription {
            transition: self.transition(),
            start_state: self.2.as_state(),
            goal_state: self.3.as_state(),
        }
    }
}

/// Told of every change, with the phase it led to.
type OnChange = Box<dyn Fn(Phase) + Send + Sync>;
/// Events kept for slow readers.
const EVENT_DEPTH: usize = 10;

/// The node's phase, and who hears of its changes.
pub struct Lifecycle {
    phase: Mutex<Phase>,
    on_change: OnChange,
    announce: OnceLock<Outlet<TransitionEvent>>,
}

impl fmt::Debug for Lifecycle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Lifecycle({:?})", self.phase())
    }
}

impl Lifecycle {
    /// A node that is not configured yet. `on_change` does what a change means.
    pub fn new(on_change: impl Fn(Phase) + Send + Sync + 'static) -> Arc<Self> {
        Arc::new(Self {
            phase: Mutex::new(Phase::Unconfigured),
            on_change: Box::new(on_change),
            announce: OnceLock::new(),
        })
    }

    /// The phase it is in.
    #[must_use]
    pub fn phase(&self) -> Phase {
        *self.phase.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// From now on, changes are published on the node's `transition_event`.
    ///
    /// # Errors
    /// When the middleware refuses.
    pub fn announce_on(&self, node: &RosNode) -> Result<(), RosError> {
        let topic = node.surface().topic("~/transition_event");
        let qos = reliable(EVENT_DEPTH);
        let outlet = node.outlet(&topic, "lifecycle_msgs/TransitionEvent", &qos)?;
        self.announce.get_or_init(|| outlet);
        Ok(())
    }

    /// As a node that nobody manages: configured and active at once.
    pub fn autostart(&self) {
        self.change(1, "configure");
        self.change(3, "activate");
    }

    /// Takes the step of that number, or of that name where the number is 0; whether the phase allows it.
    fn change(&self, id: u8, label: &str) -> bool {
        let mut phase = self.phase.lock().unwrap_or_else(PoisonError::into_inner);
        let asked = |step: &&Step| (id == 0 && step.1 == label) || step.0 == id;
        let step = STEPS.iter().filter(asked).find(|step| step.2 == *phase);
        let Some(&step) = step else {
            let at = phase.as_state().label;
            tracing::warn!(id, label, "no such transition while {at}");
            return false;
        };
        *phase = step.3;
        drop(phase);
        tracing::info!("{}: now {}", step.1, step.3.as_state().label);
        (self.on_change)(step.3);
        let event = TransitionEvent {
            // Zero, as `rclcpp` leaves it.
            timestamp: 0,
            transition: step.transition(),
            start_state: step.2.as_state(),
            goal_state: step.3.as_state(),
        };
        let announced = self.announce.get().map(|outlet| outlet.publish(event));
        if let Some(Err(error)) = announced {
            tracing::warn!(error, "not published on transition_event");
        }
        true
    }

    fn available(&self) -> AvailableTransitions {
        let phase = self.phase();
        let steps = STEPS.iter().filter(|step| step.2 == phase);
        AvailableTransitions {
            available_transitions: steps.map(|step| step.description()).collect(),
        }
    }
}

/// The five services that `ros2 lifecycle` and managers call, below the node of the absolute name `node`.
#[must_use]
pub fn services(lifecycle: &Arc<Lifecycle>, node: &str) -> Vec<Service> {
    let (change, current, available) = (
        Arc::clone(lifecycle),
        Arc::clone(lifecycle),
        Arc::clone(lifecycle),
    );
    let service = |name: &str| format!("{node}/{name}");
    let of = |type_name| ("lifecycle_msgs", type_name);
    vec![
        Service::new(
            service("change_state"),
            of("ChangeState"),
            move |asked: ChangeStateRequest| {
                let Transition { id, label } = asked.transition;
                ChangeStateResponse {
                    success: change.change(id, &label),
                }
            },
        ),
        Service::new(service("get_state"), of("GetState"), move |_: NoFields| {
            CurrentState {
                current_state: current.phase().as_state(),
            }
        }),
        Service::new(
            service("get_available_states"),
            of("GetAvailableStates"),
            |_: NoFields| AvailableStates {
                available_states: Phase::ALL.map(Phase::as_state).to_vec(),
            },
        ),
        Service::new(
            service("get_available_transitions"),
            of("GetAvailableTransitions"),
            move |_: NoFields| available.available(),
        ),
        Service::new(
            service("get_transition_graph"),
            // The same type as the one above, as `rclcpp` has it.
            of("GetAvailableTransitions"),
            |_: NoFields| AvailableTransitions {
                available_transitions: STEPS.map(Step::description).to_vec(),
            },
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_taken_only_from_where_they_begin() {
        let heard = Arc::new(Mutex::new(Vec::new()));
        let hearing = Arc::clone(&heard);
        let lifecycle = Lifecycle::new(move |phase| hearing.lock().expect("list").push(phase));
        assert!(!lifecycle.change(3, ""), "not configured yet");
        assert!(lifecycle.change(1, ""));
        assert!(lifecycle.change(0, "activate"));
        assert!(!lifecycle.change(0, "activate"), "active already");
        assert!(lifecycle.change(4, "deactivate"));
        assert!(lifecycle.change(0, "shutdown"));
        assert!(!lifecycle.change(0, "shutdown"));
        assert_eq!(
            *heard.lock().expect("list"),
            [
                Phase::Inactive,
                Phase::Active,
                Phase::Inactive,
                Phase::Finalized
            ]
        );
    }

    #[test]
    fn what_can_be_done_next_is_listed() {
        let lifecycle = Lifecycle::new(|_| {});
        lifecycle.autostart();
        let ids = |available: AvailableTransitions| -> Vec<u8> {
            let all = available.available_transitions.iter();
            all.map(|step| step.transition.id).collect()
        };
        assert_eq!(ids(lifecycle.available()), [4, 7]);
    }
}
