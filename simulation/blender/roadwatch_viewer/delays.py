"""How long scenes take: from capture and from the socket until they are in Blender's data."""

from __future__ import annotations

import math
from collections.abc import Sequence

MOST_KEPT = 100_000
LARGEST_CREDIBLE_S = 60.0
"""A stamp further from this machine's clock than this is of another clock, or of a recording."""


class Delays:
    """Collects delays, all in seconds; a report is in milliseconds."""

    def __init__(self) -> None:
        self._from_line: list[float] = []
        self._from_stamp: list[float] = []
        self._update: list[float] = []
        self.scenes = 0

    def note(self, *, from_line_s: float, from_stamp_s: float, update_s: float) -> None:
        """One scene that is in Blender now."""
        self.scenes += 1
        self._keep(self._from_line, from_line_s)
        self._keep(self._update, update_s)
        if -0.001 <= from_stamp_s <= LARGEST_CREDIBLE_S:
            self._keep(self._from_stamp, from_stamp_s)

    def report(self) -> dict[str, object]:
        """Counts and percentiles for JSON; null where nothing could be measured."""
        return {
            "scenes": self.scenes,
            "line_to_blender_ms": _summary(self._from_line),
            "stamp_to_blender_ms": _summary(self._from_stamp),
            "update_ms": _summary(self._update),
        }

    def line(self) -> str:
        """The same for a status line."""
        parts = [("line to Blender", self._from_line), ("capture to Blender", self._from_stamp)]
        said = [
            f"{name} p50 {percentile(values, 50) * 1e3:.1f} ms, p99 {percentile(values, 99) * 1e3:.1f} ms"
            for name, values in parts
            if values
        ]
        return "; ".join(said)

    @staticmethod
    def _keep(values: list[float], value: float) -> None:
        values.append(value)
        if len(values) > MOST_KEPT:
            del values[: MOST_KEPT // 2]


def percentile(values: Sequence[float], percent: float) -> float:
    """The smallest value that at least `percent` of the values do not exceed; `values` is not empty."""
    ordered = sorted(values)
    return ordered[max(math.ceil(percent / 100.0 * len(ordered)) - 1, 0)]


def _summary(values: Sequence[float]) -> dict[str, float] | None:
    if not values:
        return None
    named = {"p50": percentile(values, 50), "p99": percentile(values, 99), "max": max(values)}
    return {name: round(value * 1e3, 3) for name, value in named.items()}
