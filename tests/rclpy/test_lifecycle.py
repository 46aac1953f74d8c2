"""The node as a managed one: it works only while it is active, and ends when it is shut down."""

import pytest

from messages import OBJECTS

UNCONFIGURED, INACTIVE, ACTIVE = 1, 2, 3
CONFIGURE, CLEANUP, ACTIVATE, DEACTIVATE = 1, 2, 3, 4
SHUTDOWN = {UNCONFIGURED: 5, INACTIVE: 6, ACTIVE: 7}
ARRIVAL_SECONDS = 0.1
# Frames come several times a second.
SILENCE_SECONDS = 1.5


class Manager:
    """Calls a node's lifecycle services."""

    def __init__(self, ros):
        self.ros = ros

    def call(self, service, type_name, request):
        return self.ros.call(f"/roadwatch/{service}", f"lifecycle_msgs/srv/{type_name}", request)

    def state(self):
        return self.call("get_state", "GetState", {}).current_state.id

    def change(self, transition):
        return self.call("change_state", "ChangeState", {"transition": {"id": transition}}).success

    def available(self):
        answer = self.call("get_available_transitions", "GetAvailableTransitions", {})
        return {one.transition.id for one in answer.available_transitions}


@pytest.fixture
def managed(start, connect):
    daemon = start("--ros-args", "-p", "node.autostart:=false")
    node = connect(daemon)
    return daemon, node, Manager(node)


def is_silent(node, subscriptions):
    """Nothing comes; what was sent before the answer has a moment to arrive."""
    node.wait(lambda: False, ARRIVAL_SECONDS)
    for subscription in subscriptions:
        subscription.messages.clear()
    return not node.wait(lambda: any(one.messages for one in subscriptions), SILENCE_SECONDS)


def test_outputs_come_only_while_it_is_active(managed):
    daemon, node, manager = managed
    outputs = [node.subscribe(f"/roadwatch/{owner}/objects", OBJECTS) for owner in ["front", "scene"]]
    events = node.subscribe("/roadwatch/transition_event", "lifecycle_msgs/msg/TransitionEvent")
    assert manager.state() == UNCONFIGURED
    assert manager.available() == {CONFIGURE, SHUTDOWN[UNCONFIGURED]}
    assert node.wait(lambda: all(one.matched() == 1 for one in [*outputs, events]), 10)
    assert not manager.change(ACTIVATE), "it is not configured yet"
    assert is_silent(node, outputs)

    assert manager.change(CONFIGURE)
    assert manager.state() == INACTIVE
    assert is_silent(node, outputs)

    assert manager.change(ACTIVATE)
    assert manager.state() == ACTIVE
    assert manager.available() == {DEACTIVATE, SHUTDOWN[ACTIVE]}
    assert node.wait(lambda: all(len(one.messages) >= 2 for one in outputs), 15)

    assert manager.change(DEACTIVATE)
    assert is_silent(node, outputs)
    assert manager.change(ACTIVATE)
    assert node.wait(lambda: all(one.messages for one in outputs), 15)
    assert manager.change(DEACTIVATE)
    assert manager.change(CLEANUP)
    assert manager.state() == UNCONFIGURED
    assert is_silent(node, outputs)

    steps = [CONFIGURE, ACTIVATE, DEACTIVATE, ACTIVATE, DEACTIVATE, CLEANUP]
    assert node.wait(lambda: len(events.messages) >= len(steps), 10)
    assert [event.transition.id for event in events.messages] == steps
    assert [event.goal_state.id for event in events.messages] == [2, 3, 2, 3, 2, 1]
    assert daemon.is_running()


@pytest.mark.parametrize("phase", [UNCONFIGURED, INACTIVE, ACTIVE])
def test_it_ends_well_when_it_is_shut_down(managed, phase):
    daemon, _, manager = managed
    for step in [CONFIGURE, ACTIVATE][: phase - 1]:
        assert manager.change(step)
    assert manager.state() == phase
    assert manager.change(SHUTDOWN[phase])
    assert daemon.exit_code() == 0


def test_the_whole_graph_can_be_asked_for(managed):
    _, _, manager = managed
    states = manager.call("get_available_states", "GetAvailableStates", {}).available_states
    assert {UNCONFIGURED, INACTIVE, ACTIVE, 4} <= {state.id for state in states}
    graph = manager.call("get_transition_graph", "GetAvailableTransitions", {}).available_transitions
    steps = {(one.transition.id, one.start_state.id, one.goal_state.id) for one in graph}
    assert {(CONFIGURE, 1, 2), (ACTIVATE, 2, 3), (DEACTIVATE, 3, 2), (CLEANUP, 2, 1)} <= steps
