"""What the launch files start, and whether parameters, topics and unit are those of the daemon."""

import json
import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from stand_in import FOLDER, launch_file

ROOT = FOLDER.parent
DAEMON = Path(os.environ.get("ROADWATCH_BIN", ROOT / "target/release/roadwatch"))
LIBRARY = ROOT / ".cache/onnxruntime/libonnxruntime.so"


def daemon(*arguments):
    environment = {"ORT_DYLIB_PATH": str(LIBRARY), **os.environ}
    return subprocess.run(
        [DAEMON, *arguments], cwd=ROOT, env=environment, capture_output=True, text=True, timeout=60
    )


@pytest.fixture(scope="module")
def topics():
    """The topics of the demo, those of a recording with images, and those of every node."""
    printed = daemon("graph", "config/demo.toml").stdout
    found = set(re.findall(r"^ +(/\S+) +\w+/\w+$", printed, re.MULTILINE))
    assert len(found) > 30, printed
    cameras = {topic.split("/")[2] for topic in found if topic.endswith("/camera_info")}
    return found | {f"/roadwatch/{camera}/image/compressed" for camera in cameras} | {"/diagnostics"}


def started(**given):
    """The command line that the launch file starts."""
    module = launch_file("roadwatch.launch.py")
    values = {name: default or "" for name, default, _ in module.ARGUMENTS} | given
    (process,) = module.start(values)
    return process.named["cmd"], process.named["respawn"]


def test_the_launch_file_passes_on_what_it_is_given():
    command, respawn = started(
        config="own.toml",
        name="eyes",
        namespace="/one",
        params_file="p.yaml",
        log_level="info",
        remap="~/scene/objects:=/objects /tf_static:=/one/tf_static",
        respawn="false",
    )
    assert command[:4] == ["roadwatch", "run", "own.toml", "--ros-args"]
    said = " ".join(command)
    for part in [
        "-r __node:=eyes",
        "-r __ns:=/one",
        "-r ~/scene/objects:=/objects -r /tf_static:=/one/tf_static",
        "--params-file p.yaml",
        "-p use_sim_time:=false -p node.autostart:=true",
        "--log-level info",
    ]:
        assert part in said
    assert not respawn


def test_the_daemon_understands_what_the_launch_file_starts():
    command, respawn = started(config="config/demo.toml", executable=str(DAEMON), autoware="true")
    assert respawn
    checked = daemon("check", *command[2:])
    assert checked.returncode == 0, checked.stderr


def test_every_argument_is_declared_and_only_the_configuration_is_required():
    description = launch_file("roadwatch.launch.py").generate_launch_description()
    declared = description.given[0][:-1]
    required = [one.given[0] for one in declared if "default_value" not in one.named]
    assert required == ["config"]
    assert all(one.named["description"] for one in declared)


def test_autoware_gets_its_message_on_its_topic():
    module = launch_file("autoware.launch.py")
    include = module.generate_launch_description().given[0][-1]
    arguments = dict(include.named["launch_arguments"])
    assert Path(include.given[0].given[0]).is_file()
    graph = daemon(
        "graph", "config/demo.toml", "--ros-args", "-p", f"node.autoware:={arguments['autoware']}",
        "-r", f"__ns:={arguments['namespace']}", "-r", arguments["remap"],
    )
    assert f"{module.OBJECTS} " in graph.stdout, graph.stderr
    assert "autoware_perception_msgs/DetectedObjects" in graph.stdout


def test_the_daemon_takes_every_parameter_of_the_file():
    file = "launch-scripts/parameters.yaml"
    checked = daemon("check", "config/demo.toml", "--ros-args", "--params-file", file)
    assert checked.returncode == 0, checked.stderr
    # It would say so, were one of them unknown.
    wrong = daemon("check", "config/demo.toml", "--ros-args", "--params-file", file, "-p", "node.autowere:=true")
    assert "did you mean `autoware`" in wrong.stderr


def test_the_layouts_show_topics_that_there_are(topics):
    rviz = (FOLDER / "roadwatch.rviz").read_text()
    shown = re.findall(r"Value: (/\S+)", rviz)
    assert len(shown) == 13
    # image_transport adds the end.
    shown = [f"{topic}/compressed" if topic.endswith("image_annotated") else topic for topic in shown]
    assert set(shown) <= topics
    layout = json.loads((FOLDER / "foxglove.json").read_text())
    scene = layout["configById"]["3D!scene"]
    images = [one["imageMode"]["imageTopic"] for name, one in layout["configById"].items() if name.startswith("Image!")]
    assert set(scene["topics"]) | set(images) | {"/diagnostics"} <= topics
    panels = re.findall(r'"((?:3D|Image|DiagnosticSummary)![^"]+)"', json.dumps(layout["layout"]))
    assert sorted(panels) == sorted(layout["configById"])


def test_the_unit_is_one(tmp_path):
    if shutil.which("systemd-analyze") is None:
        pytest.skip("systemd-analyze is not there")
    unit = (FOLDER / "roadwatch.service").read_text()
    # Where the daemon is on this machine, or the check would miss it.
    unit = unit.replace("/usr/local/bin/roadwatch", str(DAEMON))
    (tmp_path / "roadwatch.service").write_text(unit)
    verified = subprocess.run(
        ["systemd-analyze", "verify", tmp_path / "roadwatch.service"], capture_output=True, text=True
    )
    assert verified.returncode == 0, verified.stderr
