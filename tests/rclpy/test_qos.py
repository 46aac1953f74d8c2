"""Which readers the daemon's publishers match, and what it says of those that they do not."""

import pytest

from messages import OBJECTS

FRAMES = "/roadwatch/front/objects"
LATCHED = ("/tf_static", "tf2_msgs/msg/TFMessage")
RELIABILITIES = ["reliable", "best_effort"]
# rcl_interfaces/Log
WARN = 30


@pytest.fixture(scope="module")
def control(node):
    """A reader that fits, to see that frames go on."""
    return node.subscribe(FRAMES, OBJECTS)


def frames_pass(node, control, count):
    """So many frames, seen by the reader that fits."""
    enough = len(control.messages) + count
    return node.wait(lambda: len(control.messages) >= enough, 15)


@pytest.mark.parametrize("reliability", RELIABILITIES)
def test_volatile_readers_get_frames(node, reliability):
    reader = node.subscribe(FRAMES, OBJECTS, reliability, "volatile")
    assert node.wait(lambda: len(reader.messages) >= 3, 15)
    assert reader.matched() == 1


@pytest.mark.parametrize("reliability", RELIABILITIES)
def test_transient_local_readers_get_no_frames(node, control, reliability):
    reader = node.subscribe(FRAMES, OBJECTS, reliability, "transient_local")
    assert frames_pass(node, control, 5)
    assert (reader.matched(), reader.messages) == (0, [])


@pytest.mark.parametrize("durability", ["volatile", "transient_local"])
@pytest.mark.parametrize("reliability", RELIABILITIES)
def test_every_reader_matches_tf_static(node, reliability, durability):
    reader = node.subscribe(*LATCHED, reliability, durability)
    assert node.wait(lambda: reader.matched() == 1, 10)
    if (reliability, durability) == ("reliable", "transient_local"):
        assert node.wait(lambda: reader.messages, 10)


def test_a_reader_that_gets_nothing_is_told_of_once(daemon, node, control):
    topic = "/roadwatch/back/objects"
    rosout = node.subscribe("/rosout", "rcl_interfaces/msg/Log", durability="transient_local")
    node.subscribe(topic, OBJECTS, durability="transient_local")

    def told():
        return [log for log in rosout.messages if topic in log.msg]

    assert node.wait(lambda: told() and daemon.said("does not fit", topic), 10)
    assert frames_pass(node, control, 5)
    (line,) = daemon.said("does not fit", topic)
    assert "WARN" in line and "transient local" in line
    (log,) = told()
    assert (log.level, log.name) == (WARN, "roadwatch")
    assert "does not fit" in log.msg and "transient local" in log.msg
    assert log.file and log.line and log.stamp.sec
