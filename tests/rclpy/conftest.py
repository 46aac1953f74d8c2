"""What tests share: one daemon for each file of tests, and a node in its domain."""

import pytest

import ros
from daemon import PROGRAM, Daemon


def pytest_report_header():
    return f"roadwatch: {PROGRAM}, heard by {ros.adapter_name()}"


def pytest_configure():
    if not PROGRAM.exists():
        pytest.exit(f"{PROGRAM} is missing: cargo build --release, or ROADWATCH_BIN=PATH", returncode=2)


@pytest.fixture(scope="module")
def start():
    """Starts daemons with these arguments; the file's last test ends them."""
    started = []

    def start_one(*arguments, **options):
        daemon = Daemon(*arguments, **options)
        started.append(daemon)
        return daemon

    yield start_one
    for daemon in started:
        daemon.stop()


@pytest.fixture(scope="module")
def connect():
    """Nodes in the domains of daemons."""
    connected = []

    def connect_to(daemon):
        node = ros.connect(daemon.domain)
        connected.append(node)
        return node

    yield connect_to
    for node in connected:
        node.close()


@pytest.fixture(scope="module")
def daemon(start):
    return start()


@pytest.fixture(scope="module")
def node(connect, daemon):
    return connect(daemon)
