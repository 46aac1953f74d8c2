"""Lamps that wrap around a corner of the shell, drawn from an oblique view."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from roadwatch_simulation.geometry import Patch
from roadwatch_simulation.vehicles.drape import LIFT_M, Drape

Outline = Sequence[tuple[float, float, float]]
"""(share from the inner to the outer end, lower edge, upper edge): edges in metres from the lamp's middle."""

POINTS = 10


def corner_lamp(
    drape: Drape,
    inner: Sequence[float],
    outer: Sequence[float],
    outline: Outline,
    span: tuple[float, float] = (0.0, 1.0),
    lift_m: float = LIFT_M,
) -> Patch:
    """A sheet from `inner` to `outer` (points in model axes), or over the shares `span` of that way."""
    start, end = drape.point(inner), drape.point(outer)
    shares = np.linspace(span[0], span[1], POINTS)
    table = np.array(outline, dtype=float)
    across = start[0] + (end[0] - start[0]) * shares
    middle = start[1] + (end[1] - start[1]) * shares
    lower = middle + np.interp(shares, table[:, 0], table[:, 1])
    upper = middle + np.interp(shares, table[:, 0], table[:, 2])
    order = np.argsort(across)
    return drape.sheet(
        np.column_stack([across, lower])[order], np.column_stack([across, upper])[order], 3, lift_m
    )
