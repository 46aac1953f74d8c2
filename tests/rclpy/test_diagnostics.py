"""/diagnostics: one status for each camera, the pipeline and each sink, once a second, with true numbers."""

import time

import pytest

from daemon import CAMERAS
from messages import OBJECTS, nanos

OK, WARN = 0, 1
# Frames may be inside the pipeline, or on their way to the reader, when numbers are taken.
UNDER_WAY = 4
CLIP_HZ = 12


class Second:
    """One message of the topic, and how many frames of a camera had been received when it came."""

    def __init__(self, message, frames):
        self.stamp = nanos(message.header.stamp)
        self.frames = frames
        self.by_name = {status.name: status for status in message.status}

    def value(self, name, key):
        values = {pair.key: pair.value for pair in self.by_name[name].values}
        return float(values[key])


@pytest.fixture(scope="module")
def seconds(node):
    frames = node.subscribe("/roadwatch/front/objects", OBJECTS)
    diagnostics = node.subscribe("/diagnostics", "diagnostic_msgs/msg/DiagnosticArray")
    assert node.wait(lambda: frames.messages, 15)
    taken = []

    def note():
        new = diagnostics.messages[len(taken) :]
        taken.extend(Second(message, len(frames.messages)) for message in new)
        return len(taken) >= 6

    assert node.wait(note, 15)
    return taken


def test_they_come_once_a_second(seconds):
    elapsed = (seconds[-1].stamp - seconds[0].stamp) / 1e9
    assert elapsed / (len(seconds) - 1) == pytest.approx(1, abs=0.2)
    assert abs(seconds[-1].stamp / 1e9 - time.time()) < 60


def test_everything_has_a_status(seconds):
    names = set(seconds[-1].by_name)
    assert {f"roadwatch: camera {camera}" for camera in CAMERAS} <= names
    assert {"roadwatch: pipeline", "roadwatch: ego motion", "roadwatch: sink ros2"} <= names
    statuses = seconds[-1].by_name
    assert all(status.message for status in statuses.values())
    assert statuses["roadwatch: camera front"].hardware_id == "front"


def test_a_camera_is_counted_truly(seconds):
    front = "roadwatch: camera front"
    first, last = seconds[0], seconds[-1]
    published = last.value(front, "published") - first.value(front, "published")
    assert published == pytest.approx(last.frames - first.frames, abs=UNDER_WAY)
    elapsed = (last.stamp - first.stamp) / 1e9
    captured = last.value(front, "captured") - first.value(front, "captured")
    assert captured / elapsed == pytest.approx(CLIP_HZ, abs=1.5)
    assert last.value(front, "captured_hz") == pytest.approx(CLIP_HZ, abs=3)
    dropped = sum(
        float(pair.value) for pair in last.by_name[front].values if pair.key.startswith("dropped_")
    )
    inside = last.value(front, "captured") - last.value(front, "published") - dropped
    assert 0 <= inside <= UNDER_WAY


def test_a_camera_that_drops_most_of_its_images_is_warned_of(seconds):
    front = "roadwatch: camera front"
    for before, now in zip(seconds, seconds[1:]):
        taken = now.value(front, "captured") - before.value(front, "captured")
        lost = now.value(front, "dropped_replaced") - before.value(front, "dropped_replaced")
        expected = WARN if lost / taken > 0.5 else OK
        assert now.by_name[front].level == expected, now.by_name[front].message


def test_the_pipeline_and_its_sink_go_on(seconds):
    first, last = seconds[0], seconds[-1]
    assert last.value("roadwatch: pipeline", "scenes") > first.value("roadwatch: pipeline", "scenes")
    assert last.value("roadwatch: pipeline", "received_to_perceived_p50_ms") > 0
    sink = "roadwatch: sink ros2"
    assert last.value(sink, "delivered") > first.value(sink, "delivered")
    assert last.value(sink, "failed") == 0
    assert last.by_name[sink].level == OK
