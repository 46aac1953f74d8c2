"""What the launch files start, and whether parameters, topics and unit are those of the daemon."""

import json
import os
import re
import shutil
import subprocess
from pathlib import Path
from types import SimpleNamespace

import pytest
from ruamel.yaml import YAML

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
    """What the launch file starts: a process, as the stand-in recorded it."""
    module = launch_file("roadwatch.launch.py")
    values = {name: default or "" for name, default, _ in module.ARGUMENTS} | given
    (process,) = module.start(values)
    return process


def parameters(text):
    """What a file of parameters sets: dotted keys and values."""

    def flat(tree, before=""):
        for key, value in tree.items():
            if isinstance(value, dict):
                yield from flat(value, f"{before}{key}.")
            else:
                yield f"{before}{key}", value

    return dict(flat(YAML(typ="safe").load(text)["/**"]["ros__parameters"]))


def test_the_launch_file_passes_on_what_it_is_given():
    command = started(
        config="own.toml",
        name="eyes",
        namespace="/one",
        params_file="p.yaml",
        log_level="info",
        use_sim_time="true",
        autostart="false",
        autoware="true",
        remap="~/scene/objects:=/objects /tf_static:=/one/tf_static",
    ).named["cmd"]
    assert command[:4] == ["roadwatch", "run", "own.toml", "--ros-args"]
    said = " ".join(command)
    for part in [
        "-r __node:=eyes",
        "-r __ns:=/one",
        "-r ~/scene/objects:=/objects -r /tf_static:=/one/tf_static",
        "--params-file p.yaml",
        "-p use_sim_time:=true -p node.autostart:=false -p node.autoware:=true",
        "--log-level info",
    ]:
        assert part in said


def test_what_is_not_given_is_left_to_the_configuration():
    assert started(config="own.toml").named["cmd"] == ["roadwatch", "run", "own.toml", "--ros-args"]


def test_the_daemon_is_started_again_after_failures_only():
    on_exit = started(config="own.toml").named["on_exit"]

    def after(code, is_shutdown=False):
        return on_exit(SimpleNamespace(returncode=code), SimpleNamespace(is_shutdown=is_shutdown))

    for failure in [1, 101, -9]:
        (timer,) = after(failure)
        (again,) = timer.named["actions"]
        assert again.named["cmd"][:3] == ["roadwatch", "run", "own.toml"]
        # And once more after that.
        assert again.named["on_exit"]
    for final in [0, 2, 78]:
        assert after(final) is None
    assert after(1, is_shutdown=True) is None
    assert started(config="own.toml", respawn="false").named["on_exit"] is None


@pytest.mark.parametrize(
    "given", [{}, {"use_sim_time": "True", "autostart": "false", "autoware": "true", "log_level": "info"}]
)
def test_the_daemon_understands_what_the_launch_file_starts(given):
    command = started(config="config/demo.toml", executable=str(DAEMON), name="eyes", namespace="/one", **given)
    checked = daemon("check", *command.named["cmd"][2:])
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


def test_the_daemon_takes_every_parameter_of_the_file(tmp_path):
    file = FOLDER / "parameters.yaml"
    text = file.read_text()
    # As it lies here, and with what stands behind a #.
    everything = tmp_path / "everything.yaml"
    everything.write_text(re.sub(r"^( {4,})# ", r"\1", text, flags=re.MULTILINE))
    assert len(parameters(everything.read_text())) == len(parameters(text)) + 6
    for one in [file, everything]:
        checked = daemon("check", "config/demo.toml", "--ros-args", "--params-file", one)
        assert checked.returncode == 0, checked.stderr
    # It would say so, were one of them unknown.
    wrong = daemon("check", "config/demo.toml", "--ros-args", "--params-file", file, "-p", "node.autowere:=true")
    assert "did you mean `autoware`" in wrong.stderr


def test_the_parameters_have_the_defaults_of_the_documentation():
    documented = {}
    table = None
    for line in (ROOT / "docs/configuration.md").read_text().splitlines():
        if heading := re.match(r"## `\[(\w+)\]`", line):
            table = heading[1]
        elif row := re.match(r"\| `(\w+)` \|[^|]*\| `([^`|]*)` \|", line):
            documented.setdefault(f"{table}.{row[1]}", row[2])
    given = parameters((FOLDER / "parameters.yaml").read_text())
    given["node.use_sim_time"] = given.pop("use_sim_time")
    assert given == {key: json.loads(documented[key]) for key in given}


def test_rviz_shows_topics_that_there_are(topics):
    manager = YAML(typ="safe").load(FOLDER / "roadwatch.rviz")["Visualization Manager"]
    shown = [(one["Class"].split("/")[1], one["Topic"]["Value"]) for one in manager["Displays"] if "Topic" in one]
    assert len(shown) == 13
    # RViz takes the transport of images from the end of the name: what ends otherwise it takes for raw images.
    assert {topic for kind, topic in shown} <= topics
    assert all(topic.endswith("/compressed") for kind, topic in shown if kind == "Image")


def test_foxglove_shows_topics_that_there_are(topics):
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
    # Of a key or a value that it does not know it only speaks.
    assert "roadwatch.service" not in verified.stderr, verified.stderr
