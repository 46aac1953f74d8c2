"""What long work says on standard error: one line, written over, on a terminal; else one now and then."""

from __future__ import annotations

import sys
import time

TERMINAL_EVERY_S = 0.2
FILE_EVERY_S = 5.0


class Progress:
    """Called with steps done, of how many."""

    def __init__(self, what: str) -> None:
        self._what = what
        self._began_s = self._said_s = time.monotonic()

    def __call__(self, done: int, total: int) -> None:
        now_s = time.monotonic()
        if done < total and now_s - self._said_s < _every_s():
            return
        self._said_s = now_s
        spent_s = now_s - self._began_s
        left = f"{spent_s / done * (total - done):.0f} s left" if 0 < done < total else f"{spent_s:.1f} s"
        say_over(f"{self._what} {done}/{total}, {left}", is_last=done >= total)


class StatusLine:
    """The state of something that goes on, said when it changes and every now and then."""

    def __init__(self) -> None:
        self._said_s = -FILE_EVERY_S
        self._kind = ""

    def say(self, kind: str, line: str) -> None:
        """`kind` is what of the line must not be missed when it changes."""
        now_s = time.monotonic()
        if kind == self._kind and now_s - self._said_s < max(_every_s(), 1.0):
            return
        is_news = kind != self._kind
        self._kind, self._said_s = kind, now_s
        say_over(line, is_last=is_news)


def say_over(line: str, *, is_last: bool) -> None:
    """Writes a line; on a terminal the next one takes its place unless this is the last."""
    if not sys.stderr.isatty():
        print(line, file=sys.stderr, flush=True)
        return
    print(f"\r\x1b[K{line}", end="\n" if is_last else "", file=sys.stderr, flush=True)


def _every_s() -> float:
    return TERMINAL_EVERY_S if sys.stderr.isatty() else FILE_EVERY_S
