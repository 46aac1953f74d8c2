"""The program as a user runs it."""

import json
import os
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest
from daemons import DEADLINE_S
from streams import FRONT, a_rig, a_scene, an_object, text

import roadwatch_viewer
from roadwatch_viewer.cli import main

ENVIRONMENT = os.environ | {"PYTHONPATH": str(Path(roadwatch_viewer.__file__).parent.parent)}
MAIN = Path(roadwatch_viewer.__file__).with_name("__main__.py")
OBJECTS = [an_object(n, (10 + n, 0, 1)) for n in range(5)]


def run(*arguments, timeout_s=60.0):
    return subprocess.run(
        [sys.executable, "-m", "roadwatch_viewer", *map(str, arguments)],
        capture_output=True,
        text=True,
        env=ENVIRONMENT,
        timeout=timeout_s,
    )


@pytest.fixture
def recording(tmp_path):
    path = tmp_path / "scene.jsonl"
    path.write_text(text([a_rig([FRONT]), *[a_scene(n, n * 10**8, OBJECTS) for n in range(5)]]))
    return path


@pytest.fixture
def small(tmp_path):
    path = tmp_path / "small.toml"
    path.write_text("width_px = 192\nheight_px = 108\nsamples = 1\n")
    return path


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["replay", "nowhere.jsonl", "--still", "a.png"], "cannot read nowhere.jsonl"),
        (["replay", "nowhere.jsonl"], "--still PNG"),
        (["follow", "nowhere"], "HOST:PORT"),
        (["replay", "a.jsonl", "--save", "a.blend", "--settings", "nowhere.toml"], "nowhere.toml"),
    ],
)
def test_mistakes_are_said_in_a_line_and_the_status_is_1(arguments, said, capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    assert main(arguments) == 1
    assert said in capsys.readouterr().err


def test_help_teaches_by_examples(capsys):
    with pytest.raises(SystemExit) as ended:
        main(["--help"])
    assert ended.value.code == 0
    assert "replay scene.jsonl --still" in capsys.readouterr().out


def test_a_replay_makes_a_still_and_a_file(blender, recording, small, tmp_path):
    still, saved = tmp_path / "out" / "a.png", tmp_path / "out" / "a.blend"
    done = run("replay", recording, "--still", still, "--at", 0.2, "--save", saved, "--settings", small)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == [str(still), str(saved)]
    assert still.read_bytes()[1:4] == b"PNG" and saved.stat().st_size > 10_000
    assert "scenes 5/5" in done.stderr


def test_the_file_runs_by_its_path_as_blender_runs_it(blender, recording, small, tmp_path):
    still = tmp_path / "a.png"
    command = [sys.executable, MAIN, "--", "replay", recording, "--still", still, "--settings", small]
    done = subprocess.run([*map(str, command)], capture_output=True, text=True, timeout=60, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert still.is_file()


class Sender:
    """Sends scenes of now, ten a second, until it is closed."""

    def __init__(self, daemon) -> None:
        self._daemon = daemon
        self.objects = OBJECTS
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._send, daemon=True)
        self._thread.start()

    def _send(self) -> None:
        self._daemon.wait_connection()
        self._daemon.send(text([a_rig([FRONT])]))
        for seq in range(10**6):
            if self._ended.wait(0.1):
                return
            try:
                self._daemon.send(text([a_scene(seq, time.time_ns(), self.objects)]))
            except OSError:
                return

    def close(self) -> None:
        self._ended.set()
        self._thread.join(DEADLINE_S)


@pytest.fixture
def sender(daemon, monkeypatch):
    monkeypatch.setattr("daemons.DEADLINE_S", 60.0)
    made = Sender(daemon)
    yield made
    made.close()


def test_following_reports_how_long_scenes_took_and_leaves_the_last_one(
    blender, daemon, sender, small, tmp_path
):
    report, still = tmp_path / "delays.json", tmp_path / "last.png"
    address = f"127.0.0.1:{daemon.port}"
    done = run("follow", address, "--seconds", 4, "--report", report, "--still", still, "--settings", small)
    assert done.returncode == 0, done.stderr
    said = json.loads(report.read_text())
    assert said["scenes"] > 5 and said["lines_left_out"] == 0
    for name in ("line_to_blender_ms", "stamp_to_blender_ms", "update_ms"):
        assert 0.0 < said[name]["p50"] <= said[name]["p99"] <= said[name]["max"]
    assert still.is_file() and f"following {address}" in done.stderr


def test_settings_are_read_again_while_following(blender, daemon, sender, small, tmp_path):
    address = f"127.0.0.1:{daemon.port}"
    command = [
        sys.executable,
        "-m",
        "roadwatch_viewer",
        "follow",
        address,
        "--seconds",
        "12",
        "--settings",
        str(small),
    ]
    following = subprocess.Popen(command, stderr=subprocess.PIPE, text=True, env=ENVIRONMENT)
    said = []
    for line in following.stderr:
        said.append(line)
        if "5 objects" in line:
            small.write_text("most_objects = 2\nlable = true\n")
        if "lable" in line:
            small.write_text("most_objects = 2\n")
        if "2 objects" in line:
            following.terminate()
    following.wait(30)
    assert any("lable: no such key" in line for line in said), said
    assert any("settings read again" in line for line in said), said


def test_a_newer_daemon_is_refused_at_once(blender, daemon):
    def greet():
        daemon.wait_connection()
        daemon.send(text([a_rig(version=3)]))

    threading.Thread(target=greet, daemon=True).start()
    done = run("follow", f"127.0.0.1:{daemon.port}", "--seconds", 50)
    assert done.returncode == 1 and "version 3" in done.stderr and "Traceback" not in done.stderr


def test_a_daemon_that_never_comes_is_an_error_that_says_where_to_look(blender):
    done = run("follow", "127.0.0.1:9", "--seconds", 1)
    assert done.returncode == 1 and "[scene_stream]" in done.stderr
