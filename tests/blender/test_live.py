"""The viewer on a daemon that runs in real time."""

import json
import os
import signal
import subprocess
import sys
import threading
import zipfile
from pathlib import Path

import pytest

from daemons import until

START_S = 60.0
"""More than a follower takes to come up beside a daemon and others that have all cores busy."""
LARGEST_P99_MS = 1000.0
"""On a machine shared with others; alone it is below a hundred."""


class Following:
    """`follow` as a process; what it says is kept."""

    def __init__(self, add_on: Path, address: str, seconds: float, report: Path) -> None:
        words = [
            "-m",
            "roadwatch_viewer",
            "follow",
            address,
            "--seconds",
            str(seconds),
            "--report",
            str(report),
        ]
        self.process = subprocess.Popen(
            [sys.executable, *words],
            env=os.environ | {"PYTHONPATH": str(add_on)},
            stderr=subprocess.PIPE,
            text=True,
        )
        self.lines: list[str] = []
        self._report = report
        self._listener = threading.Thread(target=self._listen)
        self._listener.start()

    def _listen(self) -> None:
        for line in self.process.stderr:
            self.lines.append(line)

    def wait_following(self) -> None:
        until(lambda: any("following" in line for line in self.lines), "a follower", START_S)

    def kill(self) -> None:
        self.process.send_signal(signal.SIGKILL)
        self.process.wait()
        self._listener.join()

    def finish(self) -> dict:
        """Its report, once its time is up."""
        code = self.process.wait(START_S)
        self._listener.join()
        assert code == 0, self.lines
        return json.loads(self._report.read_text())


@pytest.fixture(scope="module")
def add_on(tmp_path_factory) -> Path:
    """The add-on as it is installed: with its meshes, which otherwise take seconds at every start."""
    from roadwatch_viewer.package import build_zip

    folder = tmp_path_factory.mktemp("add_on")
    build_zip(folder / "viewer.zip")
    with zipfile.ZipFile(folder / "viewer.zip") as packed:
        packed.extractall(folder)
    return folder


def test_a_killed_follower_disturbs_nobody_and_the_next_one_draws_the_scenes_of_now(
    add_on, daemon, address, reader, tmp_path, capsys
):
    killed = Following(add_on, address, 60.0, tmp_path / "killed.json")
    killed.wait_following()
    reader.wait_more(1)
    killed.kill()
    newest, said = reader.seqs[-1], len(daemon.said("fps"))
    report = Following(add_on, address, 3.0, tmp_path / "report.json").finish()
    with capsys.disabled():
        print(f"\n{report['scenes']} scenes, line to Blender {report['line_to_blender_ms']} ms")

    assert newest < report["first_seq"] < report["last_seq"]
    assert report["scenes"] > 1 and report["lines_left_out"] == 0
    assert report["line_to_blender_ms"]["p99"] < LARGEST_P99_MS
    # The demo's stamps are those of its recording.
    assert report["stamp_to_blender_ms"] is None

    until(lambda: reader.seqs[-1] >= report["last_seq"], "the last scene that was drawn", 5.0)
    assert reader.is_connected and reader.has_every_scene()
    # One line a second.
    assert daemon.is_running() and len(daemon.said("fps")) >= said + 2
    assert not daemon.said("ERROR")
