"""use_sim_time: "now" is what /clock says, and stamps of outputs stay those of the images."""

import pytest

from messages import OBJECTS, nanos

SIMULATED_SECOND = 4242


@pytest.fixture(scope="module")
def daemon(start):
    return start("--ros-args", "-p", "use_sim_time:=true")


def test_now_is_what_the_clock_says(node):
    clock = node.publisher("/clock", "rosgraph_msgs/msg/Clock", reliability="best_effort")
    diagnostics = node.subscribe("/diagnostics", "diagnostic_msgs/msg/DiagnosticArray")
    assert node.wait(lambda: clock.matched() == 1 and diagnostics.matched() == 1, 15)

    def told():
        clock.publish({"clock": {"sec": SIMULATED_SECOND, "nanosec": 5}})
        stamps = [nanos(message.header.stamp) for message in diagnostics.messages]
        return SIMULATED_SECOND * 1_000_000_000 + 5 in stamps

    assert node.wait(told, 10)


def test_outputs_keep_the_stamps_of_their_images(node):
    objects = node.subscribe("/roadwatch/front/objects", OBJECTS)
    assert node.wait(lambda: objects.messages, 15)
    assert objects.messages[0].header.stamp.sec != SIMULATED_SECOND


def test_it_is_a_parameter_that_is_fixed(node):
    request = {"names": ["use_sim_time"]}
    answer = node.call("/roadwatch/get_parameters", "rcl_interfaces/srv/GetParameters", request)
    assert answer.values[0].bool_value
