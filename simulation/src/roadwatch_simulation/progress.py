"""How far a long job is, on standard error: a bar on a terminal, plain lines elsewhere."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from typing import TextIO

BAR_CELLS = 30
BAR_EVERY_S = 0.2
LINE_EVERY_S = 15.0

Report = Callable[[int, int], None]
"""Called with how many steps are done, of how many."""


class Progress:
    """Reports steps done; call it with (done, total)."""

    def __init__(self, what: str, stream: TextIO | None = None) -> None:
        self._what = what
        self._stream = stream or sys.stderr
        self._is_terminal = self._stream.isatty()
        self._began_s = time.monotonic()
        self._spoke_s = self._began_s

    def __call__(self, done: int, total: int) -> None:
        now_s = time.monotonic()
        every_s = BAR_EVERY_S if self._is_terminal else LINE_EVERY_S
        if done < total and now_s - self._spoke_s < every_s:
            return
        self._spoke_s = now_s
        self._stream.write(self._line(done, total, now_s - self._began_s))
        self._stream.flush()

    def _line(self, done: int, total: int, spent_s: float) -> str:
        left = f", {spent_s / done * (total - done):.0f} s left" if 0 < done < total else f", {spent_s:.0f} s"
        count = f"{self._what} {done}/{total}{left}"
        if not self._is_terminal:
            return count + "\n"
        full = round(BAR_CELLS * done / max(total, 1))
        end = "\n" if done >= total else ""
        return f"\r[{'#' * full}{'.' * (BAR_CELLS - full)}] {count}   {end}"
