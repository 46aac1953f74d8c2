"""A follower on real sockets: daemons that are absent, go, come back, or say what they should not."""

import socket
import time

import pytest
from daemons import Daemon, until
from streams import FRONT, a_rig, a_scene, an_object, text

from roadwatch_viewer import follower as following
from roadwatch_viewer.errors import ViewerError
from roadwatch_viewer.follower import Address, Follower, State
from roadwatch_viewer.reading import Warnings

HEAD = text([a_rig([FRONT])])


@pytest.fixture
def quickly(monkeypatch):
    monkeypatch.setattr(following, "FIRST_WAIT_S", 0.02)
    monkeypatch.setattr(following, "LONGEST_WAIT_S", 0.1)


@pytest.fixture
def follow():
    """Starts followers and ends them after the test."""
    started = []

    def start(port, warnings=None):
        made = Follower(Address("127.0.0.1", port), warnings or Warnings(lambda _: None))
        started.append(made)
        made.start()
        return made

    yield start
    for each in started:
        each.stop()


def next_scene(follower):
    return until(lambda: follower.take(0.1)[1], "a scene").scene


def test_scenes_arrive_whole_though_sent_in_pieces(daemon, follow):
    follower = follow(daemon.port)
    daemon.wait_connection()
    line = text([a_scene(5, 10, [an_object(1, (1, 2, 3))])])
    for piece in (HEAD[:10], HEAD[10:] + line[:50], line[50:-1], line[-1:]):
        daemon.send(piece)
    assert next_scene(follower).seq == 5
    assert follower.status.state is State.FOLLOWING


def test_a_slow_viewer_gets_the_newest_scene(daemon, follow):
    follower = follow(daemon.port)
    daemon.wait_connection()
    daemon.send(HEAD + text([a_scene(seq, seq, []) for seq in range(50)]))
    until(lambda: follower.overtaken == 49, "all scenes read")
    assert next_scene(follower).seq == 49


def test_an_absent_daemon_is_waited_for(quickly, follow):
    with socket.create_server(("127.0.0.1", 0)) as closed:
        port = closed.getsockname()[1]
    follower = follow(port)
    until(lambda: follower.status.state is State.WAITING, "waiting")
    assert "nobody listens" in follower.status.said
    daemon = Daemon(port)
    daemon.wait_connection()
    daemon.send(HEAD + text([a_scene(0, 0, [])]))
    assert next_scene(follower).seq == 0
    daemon.close()


def test_a_daemon_that_comes_back_is_followed_again(daemon, quickly, follow):
    follower = follow(daemon.port)
    daemon.wait_connection()
    daemon.send(HEAD + text([a_scene(1, 0, [])]) + '{"type": "scene", "se')
    assert next_scene(follower).seq == 1
    daemon.hang_up()
    daemon.wait_connection(2)
    daemon.send(HEAD + text([a_scene(2, 0, [])]))
    assert next_scene(follower).seq == 2
    assert follower.warnings.count == 0


def test_waits_grow_up_to_a_cap(daemon, follow, monkeypatch):
    monkeypatch.setattr(following, "FIRST_WAIT_S", 0.02)
    monkeypatch.setattr(following, "LONGEST_WAIT_S", 0.16)
    follow(daemon.port)
    moments = []
    for number in range(1, 7):
        daemon.wait_connection(number)
        moments.append(time.monotonic())
        daemon.hang_up()
    gaps = [after - before for before, after in zip(moments, moments[1:], strict=False)]
    assert gaps[0] >= 0.03 and gaps[-1] >= 0.15


def test_malformed_lines_are_counted_and_the_connection_stays(daemon, follow):
    said = []
    follower = follow(daemon.port, Warnings(said.append))
    daemon.wait_connection()
    daemon.send(HEAD + "nonsense\n" * 20 + '{"type": "news"}\n' + text([a_scene(3, 0, [])]))
    assert next_scene(follower).seq == 3
    assert (follower.warnings.count, len(said), daemon.connections) == (20, 1, 1)


def test_a_newer_version_is_refused_once_and_for_all(daemon, quickly, follow):
    follower = follow(daemon.port)
    daemon.wait_connection()
    daemon.send(text([a_rig(version=2), a_scene(0, 0, [])]))
    until(lambda: follower.status.state is State.REFUSED, "the refusal")
    assert "version 2" in follower.status.said
    follower._thread.join(2.0)
    assert not follower._thread.is_alive()
    assert daemon.connections == 1 and follower.take() == (None, None)


def test_scenes_before_the_first_line_are_left_out(daemon, follow):
    follower = follow(daemon.port)
    daemon.wait_connection()
    daemon.send(text([a_scene(0, 0, [])]) + HEAD + text([a_scene(1, 0, [])]))
    assert next_scene(follower).seq == 1
    assert follower.warnings.count == 1


def test_stopping_takes_no_longer_than_a_second_though_nothing_comes(daemon, follow):
    follower = follow(daemon.port)
    daemon.wait_connection()
    began_s = time.monotonic()
    follower.stop()
    assert time.monotonic() - began_s < 1.5
    assert follower.status.state is State.STOPPED


@pytest.mark.parametrize("wrong", ["", "host", "host:", ":80", "host:99999", "host:x", "host:0"])
def test_a_wrong_address_is_refused_with_an_example(wrong):
    with pytest.raises(ViewerError, match="127.0.0.1:"):
        Address.parse(wrong)


def test_an_address_may_be_ipv6():
    assert Address.parse("[::1]:7600") == Address("::1", 7600)
