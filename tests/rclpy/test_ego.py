"""Transforms that tell where the vehicle is, and what /diagnostics says when they stop or cannot be."""

import pytest

from daemon import DEMO, ROOT
from messages import OBJECTS, stamps

TF = "tf2_msgs/msg/TFMessage"
SECOND = 1_000_000_000
PERIOD = SECOND // 50
OK, WARN = 0, 1


@pytest.fixture(scope="module")
def daemon(start, tmp_path_factory):
    config = tmp_path_factory.mktemp("ego") / "ego.toml"
    text = DEMO.read_text().replace('"../', f'"{ROOT}/')
    config.write_text(text + '\n[ego]\ntf_frame = "odom"\n')
    return start(config=config)


def transform(parent: str, child: str, stamp: int, x_m: float) -> dict:
    return {
        "header": {"stamp": {"sec": stamp // SECOND, "nanosec": stamp % SECOND}, "frame_id": parent},
        "child_frame_id": child,
        "transform": {
            "translation": {"x": x_m, "y": 0.0, "z": 0.0},
            "rotation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0},
        },
    }


class Vehicle:
    """Drives at 10 m/s, and publishes where it is ahead of the images."""

    def __init__(self, node):
        self.node = node
        self.objects = node.subscribe("/roadwatch/front/objects", OBJECTS)
        self.diagnostics = node.subscribe("/diagnostics", "diagnostic_msgs/msg/DiagnosticArray")
        self.tf = node.publisher("/tf", TF)
        self.tf_static = node.publisher("/tf_static", TF, durability="transient_local")
        assert node.wait(lambda: self.tf.matched() == 1 and self.tf_static.matched() >= 1, 15)
        assert node.wait(lambda: self.objects.messages, 15)
        self.stamp = stamps(self.objects)[-1]
        self.x_m = 0.0

    def step(self):
        self.stamp += PERIOD
        self.x_m += 10 * PERIOD / SECOND
        # A wheel that turns, with a stamp far ahead, says nothing of the vehicle.
        wheel = transform("base_link", "wheel", self.stamp + SECOND, 0.0)
        moved = transform("odom", "base_footprint", self.stamp, self.x_m)
        self.tf.publish({"transforms": [moved, wheel]})

    def catch_up(self):
        """Publishes until it is half a second ahead of what is seen."""
        while self.stamp < stamps(self.objects)[-1] + SECOND // 2:
            self.step()

    def status(self):
        """The newest status of it, with its values."""
        for message in reversed(self.diagnostics.messages):
            for status in message.status:
                if status.name == "roadwatch: ego motion":
                    return status.level, status.message, {one.key: one.value for one in status.values}
        return None, "", {}


@pytest.fixture(scope="module")
def vehicle(node):
    return Vehicle(node)


def test_a_topic_that_has_not_spoken_is_warned_of(node, vehicle):
    assert node.wait(lambda: vehicle.status()[1], 15)
    level, message, values = vehicle.status()
    assert level == WARN and message.endswith("has told nothing yet")
    assert values["taken"] == "0" and "/tf" in values["source"]
    assert vehicle.objects.messages[-1].ego_motion == "none"


def test_poses_come_through_frames_in_between(node, vehicle):
    vehicle.tf_static.publish({"transforms": [transform("base_footprint", "base_link", 0, 0.5)]})

    def is_measured():
        vehicle.catch_up()
        return vehicle.objects.messages[-1].ego_motion == "measured"

    assert node.wait(is_measured, 20)

    def is_told():
        vehicle.catch_up()
        return vehicle.status()[0] == OK

    assert node.wait(is_told, 10)
    values = vehicle.status()[2]
    assert int(values["taken"]) > 20
    # The wheel's stamps, ahead of the vehicle's, have refused none and moved nothing.
    assert (values["refused"], values["jumps"], values["restarts"]) == ("0", "0", "0")
    assert "age_s" in values


def test_a_camera_that_is_told_to_be_in_two_places_is_named(node, vehicle, daemon):
    for x_m in [1.0, 2.0, 1.0]:
        vehicle.tf_static.publish({"transforms": [transform("base_link", "doubled_camera", 0, x_m)]})
    assert node.wait(lambda: daemon.said("WARN", "doubled_camera", "in two places"), 10)
    assert len(daemon.said("WARN", "doubled_camera")) == 1


def test_transforms_that_stop_are_warned_of_and_the_vehicle_stands(node, vehicle, daemon):
    assert node.wait(lambda: vehicle.objects.messages[-1].ego_motion == "stale", 10)
    assert node.wait(lambda: vehicle.status()[1].endswith("tells nothing any more"), 10)
    assert vehicle.status()[0] == WARN
    assert node.wait(lambda: daemon.said("WARN", "nothing says any more where the vehicle is"), 10)
    assert daemon.is_running()
