//! `lifecycle_msgs`: states and transitions of a managed node, and requests about them.

use serde::{Deserialize, Serialize};

/// A state of the node.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct State {
    /// 1 unconfigured, 2 inactive, 3 active, 4 finalized.
    pub id: u8,
    /// Its name.
    pub label: String,
}

/// A way from one state to another.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Transition {
    /// 1 configure, 2 cleanup, 3 activate, 4 deactivate, 5 to 7 shutdown.
    pub id: u8,
    /// Its name.
    pub label: String,
}

/// A transition with its ends.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TransitionDescription {
    /// The transition.
    pub transition: Transition,
    /// Where it begins.
    pub start_state: State,
    /// Where it leads to.
    pub goal_state: State,
}

/// A transition that took place.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TransitionEvent {
    /// When, nanoseconds.
    pub timestamp: u64,
    /// The transition.
    pub transition: Transition,
    /// Where it began.
    pub start_state: State,
    /// Where it led to.
    pub goal_state: State,
}

/// Asks for a transition.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ChangeStateRequest {
    /// By number, or by name where the number is 0.
    pub transition: Transition,
}

/// Whether it took place.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ChangeStateResponse {
    /// Whether it took place.
    pub success: bool,
}

/// A request without fields, which ROS gives one because IDL has no empty structs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct NoFields {
    /// Means nothing.
    pub structure_needs_at_least_one_member: u8,
}

/// The state it is in.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct CurrentState {
    /// The state.
    pub current_state: State,
}

/// The states there are.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct AvailableStates {
    /// All of them.
    pub available_states: Vec<State>,
}

/// Transitions that can be asked for.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct AvailableTransitions {
    /// Those.
    pub available_transitions: Vec<TransitionDescription>,
}
