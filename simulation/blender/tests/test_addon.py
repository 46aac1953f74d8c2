"""The add-on as a user gets it: the zip, installed into Blender, without anything else of ours."""

import json
import socket
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest
from streams import FRONT, a_rig, a_scene, an_object, text

import roadwatch_viewer
from roadwatch_viewer.package import build_zip

HERE = Path(__file__).parent


@pytest.fixture(scope="module")
def zipped(tmp_path_factory):
    path = tmp_path_factory.mktemp("zip") / "roadwatch_viewer.zip"
    build_zip(path)
    return path


def test_the_zip_has_a_manifest_and_nothing_that_blender_lacks(zipped):
    with zipfile.ZipFile(zipped) as opened:
        names = opened.namelist()
        manifest = tomllib.loads(opened.read("roadwatch_viewer/blender_manifest.toml").decode())
        sources = "".join(opened.read(name).decode() for name in names if name.endswith(".py"))
    assert manifest["type"] == "add-on" and manifest["blender_version_min"] == "4.2.0"
    assert "roadwatch_viewer/meshes.npz" in names and "roadwatch_viewer/__init__.py" in names
    for absent in (
        "import scipy",
        "import cv2",
        "import moderngl",
        "import roadwatch_simulation",
        "from roadwatch_simulation",
    ):
        assert absent not in sources
    assert zipped.stat().st_size < 2_000_000


def test_the_same_sources_make_the_same_zip(zipped, tmp_path):
    build_zip(tmp_path / "again.zip")
    with zipfile.ZipFile(zipped) as first, zipfile.ZipFile(tmp_path / "again.zip") as second:
        assert [
            (each.filename, each.CRC) for each in first.infolist() if not each.filename.endswith("npz")
        ] == [(each.filename, each.CRC) for each in second.infolist() if not each.filename.endswith("npz")]


def test_the_version_is_said_the_same_everywhere():
    package = HERE.parent
    project = tomllib.loads((package / "pyproject.toml").read_text())["project"]["version"]
    manifest = tomllib.loads((package / "roadwatch_viewer" / "blender_manifest.toml").read_text())["version"]
    assert project == manifest == ".".join(map(str, roadwatch_viewer.bl_info["version"]))


def run_installed(zipped, folder, script, *arguments):
    """Runs a script in a Blender of its own that has the zip as its only trace of this project."""
    with zipfile.ZipFile(zipped) as opened:
        opened.extractall(folder)
    code = f"import sys; sys.path.insert(0, {str(folder)!r})\nsys.modules['roadwatch_simulation'] = None\n"
    code += "sys.modules['scipy'] = sys.modules['cv2'] = sys.modules['moderngl'] = None\n" + script
    done = subprocess.run(
        [sys.executable, "-c", code, *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=120,
        cwd=folder,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_the_add_on_switches_on_draws_its_panels_and_switches_off(blender, zipped, tmp_path):
    said = run_installed(zipped, tmp_path, (HERE / "in_blender_panels.py").read_text())
    assert said.splitlines()[-1] == "done"


def test_the_add_on_follows_a_daemon_that_comes_and_goes(blender, zipped, tmp_path):
    """The script's Blender follows before anyone listens; timers do not run there, so it ticks itself."""
    with socket.create_server(("127.0.0.1", 0)) as closed:
        port = closed.getsockname()[1]
    script = (HERE / "in_blender_follow.py").read_text()
    scene = text([a_rig([FRONT]), a_scene(0, 0, [an_object(n, (10 + n, 0, 1)) for n in range(5)])])
    (tmp_path / "lines").write_text(json.dumps(scene))
    said = run_installed(zipped, tmp_path / "in", script, port, tmp_path / "lines")
    assert said.splitlines()[-1] == "done"


def test_the_add_on_replays_and_renders(blender, zipped, tmp_path):
    recording = tmp_path / "scene.jsonl"
    recording.write_text(
        text([a_rig([FRONT]), *[a_scene(n, n * 10**8, [an_object(1, (10 + n, 0, 1))]) for n in range(5)]])
    )
    said = run_installed(zipped, tmp_path / "in", (HERE / "in_blender_replay.py").read_text(), recording)
    assert said.splitlines()[-1] == "done"


def test_blender_installs_the_zip_as_an_extension(blender, zipped, tmp_path):
    script = (HERE / "in_blender_install.py").read_text()
    done = subprocess.run(
        [sys.executable, "-c", script, str(zipped)], capture_output=True, text=True, timeout=120,
        env={"PATH": "/usr/bin:/bin", "HOME": str(tmp_path), "BLENDER_USER_RESOURCES": str(tmp_path)},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr + done.stdout
    assert done.stdout.splitlines()[-1] == "done"
