"""A plain reader of the scene stream."""

from __future__ import annotations

import json
import socket
import threading

from daemons import until


class Reader:
    """Reads everything, and keeps the numbers of the scenes."""

    def __init__(self, host: str, port: int) -> None:
        self.seqs: list[int] = []
        self.is_connected = True
        self._link = socket.create_connection((host, port), 5.0)
        self._link.settimeout(None)
        self._thread = threading.Thread(target=self._read)
        self._thread.start()

    def _read(self) -> None:
        with self._link.makefile("rb") as lines:
            for line in lines:
                said = json.loads(line)
                if said["type"] == "scene":
                    self.seqs.append(said["seq"])
        self.is_connected = False

    def wait_more(self, count: int, seconds: float = 10.0) -> None:
        """Until so many more scenes have come."""
        wanted = len(self.seqs) + count
        until(lambda: len(self.seqs) >= wanted, f"{count} more scenes", seconds)

    def has_every_scene(self) -> bool:
        """Whether no scene is missing from the first one to the last."""
        return self.seqs == list(range(self.seqs[0], self.seqs[-1] + 1))

    def close(self) -> None:
        """Lets the daemon go."""
        self._link.shutdown(socket.SHUT_RDWR)
        self._thread.join()
        self._link.close()
