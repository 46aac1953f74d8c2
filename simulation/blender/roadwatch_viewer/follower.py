"""Follows a running daemon from a thread of its own: whoever draws never waits for the network."""

from __future__ import annotations

import socket
import threading
import time
from dataclasses import dataclass
from enum import Enum

from .errors import MalformedLine, NewerVersion, ViewerError
from .reading import LineBuffer, LineReader, Warnings
from .schema import Rig, Scene

FIRST_WAIT_S, LONGEST_WAIT_S = 0.25, 5.0
CONNECT_TIMEOUT_S = 3.0
STOP_CHECK_S = 0.2
PIECE_BYTES = 256 * 1024


class State(Enum):
    """What a follower is doing."""

    CONNECTING = "connecting"
    FOLLOWING = "following"
    WAITING = "waiting"
    REFUSED = "refused"
    STOPPED = "stopped"


@dataclass(frozen=True)
class Status:
    """A state, and in words what happened."""

    state: State
    said: str


@dataclass(frozen=True)
class Received:
    """A scene, and when its line was complete (time.monotonic)."""

    scene: Scene
    received_s: float


@dataclass(frozen=True)
class Address:
    """Where the daemon listens."""

    host: str
    port: int

    @staticmethod
    def parse(text: str) -> Address:
        """Of HOST:PORT, with an IPv6 host in brackets. Raises ViewerError."""
        host, colon, port = text.rpartition(":")
        host = host.removeprefix("[").removesuffix("]")
        if not colon or not host or not port.isdecimal() or not 0 < int(port) < 65536:
            raise ViewerError(
                f"{text!r} is no HOST:PORT such as 127.0.0.1:7600 (see [scene_stream] of the daemon)"
            )
        return Address(host, int(port))

    def __str__(self) -> str:
        return f"[{self.host}]:{self.port}" if ":" in self.host else f"{self.host}:{self.port}"


class Follower:
    """Connects, reads, and connects again after a while; keeps the newest scene for `take`."""

    def __init__(self, address: Address, warnings: Warnings | None = None) -> None:
        self.address = address
        self.warnings = warnings or Warnings()
        self.overtaken = 0
        """Scenes that a newer one replaced before they were taken."""
        self._rig: Rig | None = None
        self._newest: Received | None = None
        self._fresh = threading.Condition()
        self._stop = threading.Event()
        self._status = Status(State.CONNECTING, f"connecting to {address}")
        self._thread = threading.Thread(target=self._follow, name="roadwatch follower", daemon=True)

    def start(self) -> None:
        self._thread.start()

    def stop(self) -> None:
        """Ends the thread; returns within a second or so, whatever the network does."""
        self._stop.set()
        with self._fresh:
            self._fresh.notify_all()
        if self._thread.ident is not None:
            self._thread.join(timeout=1.0)
        if self.status.state is not State.REFUSED:
            self._set_status(State.STOPPED, "stopped")

    @property
    def status(self) -> Status:
        return self._status

    def take(self, timeout_s: float = 0.0) -> tuple[Rig | None, Received | None]:
        """The rig line and the newest scene that came since the last call; None for what did not."""
        with self._fresh:
            if self._newest is None and self._rig is None and timeout_s > 0.0:
                self._fresh.wait(timeout_s)
            rig, newest = self._rig, self._newest
            self._rig = self._newest = None
        return rig, newest

    def _follow(self) -> None:
        wait_s = FIRST_WAIT_S
        while not self._stop.is_set():
            try:
                had_scenes, ended = self._read_connection()
            except NewerVersion as error:
                self._set_status(State.REFUSED, str(error))
                return
            wait_s = FIRST_WAIT_S if had_scenes else min(2.0 * wait_s, LONGEST_WAIT_S)
            if not self._stop.is_set():
                self._set_status(State.WAITING, f"{ended}; trying {self.address} again every few seconds")
                self._stop.wait(wait_s)

    def _read_connection(self) -> tuple[bool, str]:
        """Reads until the connection ends: whether a scene came, and why it ended."""
        self._set_connecting()
        try:
            link = socket.create_connection((self.address.host, self.address.port), CONNECT_TIMEOUT_S)
        except OSError as error:
            return False, f"nobody listens at {self.address} ({error.strerror or error})"
        with link:
            link.settimeout(STOP_CHECK_S)
            return self._read_lines(link)

    def _read_lines(self, link: socket.socket) -> tuple[bool, str]:
        buffer, reader = LineBuffer(), LineReader(str(self.address), self.warnings)
        had_scenes = False
        while not self._stop.is_set():
            try:
                piece = link.recv(PIECE_BYTES)
                lines = buffer.push(piece)
            except TimeoutError:
                continue
            except OSError as error:
                return had_scenes, f"the connection broke ({error.strerror or error})"
            except MalformedLine as error:
                self.warnings.warn(f"{self.address}: connection dropped: {error}")
                return had_scenes, str(error)
            if not piece:
                return had_scenes, "the daemon closed the connection"
            received_s = time.monotonic()
            for line in lines:
                had_scenes |= self._keep(reader.read(line), received_s)
        return had_scenes, "stopped"

    def _keep(self, said: Rig | Scene | None, received_s: float) -> bool:
        """Puts what a line said where `take` finds it; True for a scene."""
        if said is None:
            return False
        with self._fresh:
            if isinstance(said, Rig):
                self._rig = said
            else:
                self.overtaken += self._newest is not None
                self._newest = Received(said, received_s)
            self._fresh.notify_all()
        self._set_status(State.FOLLOWING, f"following {self.address}")
        return isinstance(said, Scene)

    def _set_connecting(self) -> None:
        """Keeps the reason of the last failure readable while trying again."""
        if self._status.state is not State.WAITING:
            self._set_status(State.CONNECTING, f"connecting to {self.address}")

    def _set_status(self, state: State, said: str) -> None:
        self._status = Status(state, said)
