"""Names and parameters as launch files pass them, behind --ros-args."""

import pytest

from messages import OBJECTS
from parameters import ParameterClient

RULES = ["-r", "__node:=eyes", "-r", "__ns:=/one", "-r", "~/scene/objects:=/perception/objects"]


@pytest.fixture(scope="module")
def daemon(start, tmp_path_factory):
    """Renamed, with parameters from a file, the command line, and both."""
    file = tmp_path_factory.mktemp("parameters") / "parameters.yaml"
    file.write_text(
        "/**:\n  ros__parameters:\n    detector: {score_threshold: 0.6, classes: [car, bus]}\n"
        "/one/eyes:\n  ros__parameters:\n    node.base_frame: vehicle\n"
        "/other:\n  ros__parameters:\n    node.base_frame: wrong\n"
    )
    given = ["-p", "detector.score_threshold:=0.25"]
    return start("--ros-args", *RULES, "--params-file", str(file), *given)


def test_topics_have_the_names_that_were_asked_for(node):
    found = [
        node.subscribe("/perception/objects", OBJECTS),
        node.subscribe("/one/eyes/front/objects", OBJECTS),
    ]
    absent = [
        node.subscribe("/one/eyes/scene/objects", OBJECTS),
        node.subscribe("/roadwatch/front/objects", OBJECTS),
    ]
    assert node.wait(lambda: all(one.messages for one in found), 15)
    assert not any(one.matched() for one in absent)
    assert {header.frame_id for header in (one.messages[0].header for one in found)} == {"vehicle"}


def test_the_graph_knows_the_node_by_its_new_name(node):
    assert node.wait(lambda: "/one/eyes" in node.node_names(), 10)
    assert "/roadwatch" not in node.node_names()


def test_parameters_come_from_files_and_the_last_given_counts(node):
    parameters = ParameterClient(node, "/one/eyes")
    names = ["detector.score_threshold", "detector.classes", "node.base_frame"]
    assert parameters.get(*names) == [0.25, ["car", "bus"], "vehicle"]


def test_diagnostics_and_logs_go_by_the_new_name(node):
    diagnostics = node.subscribe("/diagnostics", "diagnostic_msgs/msg/DiagnosticArray")
    rosout = node.subscribe("/rosout", "rcl_interfaces/msg/Log", durability="transient_local")
    node.subscribe("/one/eyes/front/objects", OBJECTS, durability="transient_local")
    assert node.wait(lambda: diagnostics.messages and rosout.messages, 10)
    assert {log.name for log in rosout.messages} == {"one.eyes"}
    assert {status.name.split(":")[0] for status in diagnostics.messages[0].status} == {"eyes"}
