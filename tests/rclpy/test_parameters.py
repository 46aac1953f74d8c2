"""Parameters: asked for, described, set while the daemon works, refused with a reason."""

import pytest

from daemon import CAMERAS
from messages import OBJECTS
from parameters import BOOL, DOUBLE, NOT_SET, STRING, STRINGS, ParameterClient, as_plain

THRESHOLD = "detector.score_threshold"
# As in config/demo.toml.
CONFIGURED = 0.5


@pytest.fixture(scope="module")
def parameters(node):
    return ParameterClient(node, "/roadwatch")


@pytest.fixture(scope="module")
def events(node, parameters):
    subscription = node.subscribe("/parameter_events", "rcl_interfaces/msg/ParameterEvent")

    def is_heard():
        parameters.set_each({THRESHOLD: CONFIGURED})
        return subscription.messages

    # Matching says little here: other endpoints of the daemon's node may be on this topic.
    assert node.wait(is_heard, 10)
    return subscription


@pytest.fixture(scope="module")
def objects(node):
    """Objects of every camera, and of the scene."""
    topics = {owner: f"/roadwatch/{owner}/objects" for owner in [*CAMERAS, "scene"]}
    return {owner: node.subscribe(topic, OBJECTS) for owner, topic in topics.items()}


def changed(events) -> list[tuple]:
    """Names and values that were told of."""
    return [(one.name, as_plain(one.value)) for event in events.messages for one in event.changed_parameters]


def test_all_are_listed(parameters):
    names = parameters.listed().names
    assert {THRESHOLD, "detector.classes", "use_sim_time", "node.base_frame"} <= set(names)
    assert {f"enabled.{camera}" for camera in CAMERAS} <= set(names)
    assert len(names) == len(set(names))


def test_those_below_a_prefix_are_listed(parameters):
    listed = parameters.listed("enabled")
    assert set(listed.names) == {f"enabled.{camera}" for camera in CAMERAS}
    assert listed.prefixes == ["enabled"]
    assert parameters.listed(depth=1).names == ["use_sim_time"]


def test_values_and_types_are_those_of_the_configuration(parameters):
    names = [THRESHOLD, "enabled.front", "detector.classes", "node.base_frame", "nothing.such"]
    assert parameters.get(*names) == [CONFIGURED, True, [], "base_link", None]
    assert parameters.types(*names) == [DOUBLE, BOOL, STRINGS, STRING, NOT_SET]


def test_ranges_and_what_is_fixed_are_described(parameters):
    threshold, frame = parameters.describe(THRESHOLD, "node.base_frame")
    (allowed,) = threshold.floating_point_range
    assert (allowed.from_value, allowed.to_value) == (0, 1)
    assert (threshold.name, threshold.type, threshold.read_only) == (THRESHOLD, DOUBLE, False)
    assert threshold.description and frame.description
    assert (frame.type, frame.read_only) == (STRING, True)


def test_a_threshold_takes_objects_away_and_brings_them_back(node, parameters, objects):
    scenes = objects["scene"].messages

    def last_are_empty():
        return len(scenes) >= 3 and not any(scene.objects for scene in scenes[-3:])

    assert node.wait(lambda: scenes and scenes[-1].objects, 15)
    (result,) = parameters.set_each({THRESHOLD: 1.0})
    assert result.successful, result.reason
    scenes.clear()
    assert node.wait(last_are_empty, 15)
    assert parameters.get(THRESHOLD) == [1.0]
    (result,) = parameters.set_each({THRESHOLD: CONFIGURED})
    assert result.successful, result.reason
    assert node.wait(lambda: scenes[-1].objects, 15)


def test_a_camera_goes_and_comes_back(node, parameters, objects):
    front, back, scene = (objects[owner].messages for owner in ["front", "back", "scene"])

    def back_goes_on(frames):
        enough = len(back) + frames
        return node.wait(lambda: len(back) >= enough, 15)

    assert node.wait(lambda: front, 15)
    (result,) = parameters.set_each({"enabled.front": False})
    assert result.successful, result.reason
    # What is under way may still come.
    assert back_goes_on(3)
    front.clear()
    scene.clear()
    assert back_goes_on(5)
    assert not front
    assert node.wait(lambda: scene, 15), "a camera that is switched off holds up no scene"
    (result,) = parameters.set_each({"enabled.front": True})
    assert result.successful, result.reason
    assert node.wait(lambda: len(front) >= 2, 15)


@pytest.mark.parametrize(
    ("name", "value", "reason"),
    [
        (THRESHOLD, "high", "double"),
        (THRESHOLD, 1.5, "out of range"),
        ("enabled.front", 1, "bool"),
        ("detector.classes", ["unicorn"], "unicorn"),
        ("node.base_frame", "map", "fixed"),
        ("nothing.such", 1, "not declared"),
    ],
)
def test_what_cannot_be_is_refused_with_a_reason(parameters, events, name, value, reason):
    before = parameters.get(name)
    (result,) = parameters.set_each({name: value})
    assert not result.successful
    assert reason in result.reason
    assert parameters.get(name) == before
    assert (name, value) not in changed(events)


def test_of_several_each_has_its_own_result(parameters):
    results = parameters.set_each({"enabled.back": True, THRESHOLD: -1.0, "enabled.left": True})
    assert [result.successful for result in results] == [True, False, True]


def test_together_means_all_or_none(node, parameters, events):
    events.messages.clear()
    refused = parameters.set_together({"enabled.back": False, THRESHOLD: 2.0})
    assert not refused.successful and THRESHOLD in refused.reason
    assert parameters.get("enabled.back", THRESHOLD) == [True, CONFIGURED]
    done = parameters.set_together({"enabled.back": False, THRESHOLD: 0.5})
    assert done.successful, done.reason
    assert parameters.get("enabled.back", THRESHOLD) == [False, 0.5]
    back = parameters.set_together({"enabled.back": True, THRESHOLD: CONFIGURED})
    assert back.successful, back.reason
    expected = [("enabled.back", False), (THRESHOLD, 0.5), ("enabled.back", True), (THRESHOLD, CONFIGURED)]
    # Those of earlier tests may still have been on their way.
    assert node.wait(lambda: changed(events)[-len(expected) :] == expected, 10)
    assert changed(events).count(("enabled.back", False)) == 1, "what was refused is no event"


def test_an_event_says_whose_parameter_it_was(node, parameters, events):
    parameters.set_each({THRESHOLD: 0.47})
    parameters.set_each({THRESHOLD: CONFIGURED})
    assert node.wait(lambda: (THRESHOLD, 0.47) in changed(events), 10)
    event = events.messages[-1]
    assert event.node == "/roadwatch"
    assert event.stamp.sec > 0
