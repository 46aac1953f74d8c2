"""What the tests share: what they need to run at all, and one daemon with a reader that never fails it."""

import os
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
# The daemon as a process is the black-box harness's, and waiting the viewer's own tests'.
sys.path += [str(ROOT / "tests/rclpy"), str(ROOT / "simulation/blender/tests")]

from daemon import ONNX_RUNTIME, PROGRAM, Daemon
from daemons import until
from reader import Reader


def missing() -> str | None:
    """What keeps these tests from running, or None."""
    if "ROADWATCH_BIN" not in os.environ:
        return "ROADWATCH_BIN does not say where the program is"
    if not PROGRAM.exists():
        return f"{PROGRAM} (ROADWATCH_BIN) is not there"
    library = Path(os.environ.get("ORT_DYLIB_PATH", ONNX_RUNTIME))
    if not library.exists():
        return f"ONNX Runtime is not there ({library}): ./dev setup, or ORT_DYLIB_PATH"
    try:
        import bpy  # noqa: F401
        import mcap_ros2  # noqa: F401
        import roadwatch_viewer  # noqa: F401
    except ImportError as error:
        return f"{error}: see README.md"
    return None


LACKING = missing()
SKIPPED = f"BLENDER IS NOT TESTED WITH THE DAEMON: {LACKING}"


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    here = Path(__file__).parent
    for item in items:
        if LACKING is not None and here in item.path.parents:
            item.add_marker(pytest.mark.skip(reason=SKIPPED))


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Says it without `-rs`, too."""
    if LACKING is not None:
        terminalreporter.write_line(SKIPPED, yellow=True)


@pytest.fixture(scope="module")
def daemon() -> Iterator[Daemon]:
    """The demo in real time, over and over, with its scene on a free port."""
    started = Daemon("--scene-stream", "127.0.0.1:0")
    yield started
    started.stop()


@pytest.fixture(scope="module")
def address(daemon: Daemon) -> str:
    """Where the daemon offers its scene."""
    line = until(lambda: daemon.said("scene stream:") or not daemon.is_running(), "the scene stream", 15.0)
    assert line is not True, daemon.lines
    return line[0].split()[-1]


@pytest.fixture(scope="module")
def reader(address: str) -> Iterator[Reader]:
    """A plain reader beside the followers."""
    host, port = address.rsplit(":", 1)
    started = Reader(host, int(port))
    yield started
    started.close()
