"""A daemon of a few lines on a real socket, and waiting for what it brings about."""

from __future__ import annotations

import socket
import threading
import time
from collections.abc import Callable
from typing import TypeVar

DEADLINE_S = 10.0

Found = TypeVar("Found")


class Daemon:
    """Listens on a port and writes what it is told to; connections are taken one after the other."""

    def __init__(self, port: int = 0) -> None:
        self._listener = socket.create_server(("127.0.0.1", port))
        self.port = self._listener.getsockname()[1]
        self.connections = 0
        self._link: socket.socket | None = None
        self._changed = threading.Condition()
        self._thread = threading.Thread(target=self._accept, daemon=True)
        self._thread.start()

    def _accept(self) -> None:
        while True:
            try:
                link, _ = self._listener.accept()
            except OSError:
                return
            with self._changed:
                self.connections += 1
                self._link = link
                self._changed.notify_all()

    def wait_connection(self, number: int = 1) -> None:
        with self._changed:
            assert self._changed.wait_for(lambda: self.connections >= number, DEADLINE_S)

    def send(self, text: str | bytes) -> None:
        self._link.sendall(text.encode() if isinstance(text, str) else text)

    def hang_up(self) -> None:
        self._link.close()

    def close(self) -> None:
        self._listener.shutdown(socket.SHUT_RDWR)
        self._listener.close()
        if self._link is not None:
            self._link.close()


def until(happened: Callable[[], Found], what: str = "it", seconds: float = DEADLINE_S) -> Found:
    """Waits until something is true, and returns it."""
    end_s = time.monotonic() + seconds
    while time.monotonic() < end_s:
        if found := happened():
            return found
        time.sleep(0.01)
    raise AssertionError(f"{what} did not happen within {seconds:.0f} s")
