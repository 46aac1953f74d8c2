"""An open test ground: asphalt, a line along each axis, and a few trees far off."""

from __future__ import annotations

import math

import numpy as np

from .layout import Place
from .palette import WHITE_PAINT
from .section import MARKING_Z_M
from .site import Site
from .skyline import add_surroundings

HALF_M = 90.0
LINE_GAP_M = 10.0


def build_plain(seed: int) -> Place:
    """A flat ground with marks every ten metres."""
    site = Site("plain", seed)
    add_surroundings(site, 140.0)
    site.road((-HALF_M, HALF_M), (-HALF_M, HALF_M))
    ticks = np.arange(-HALF_M + LINE_GAP_M, HALF_M, LINE_GAP_M)
    for axis in (0, 1):
        half = np.array([0.5, 0.06]) if axis == 0 else np.array([0.06, 0.5])
        middle = np.zeros((len(ticks), 2))
        middle[:, axis] = ticks
        site.builder.rectangles(middle - half, middle + half, MARKING_Z_M, WHITE_PAINT)
    for _ in range(24):
        angle, distance = site.rng.uniform(0, 2 * math.pi), site.rng.uniform(100.0, 135.0)
        site.tree(distance * math.cos(angle) * 1.1, distance * math.sin(angle) * 1.1)
    for offset in (-2.0, 2.0):
        site.lane((-HALF_M, offset), (HALF_M, offset), 3.5)
    site.walk((-30.0, 8.0), (40.0, 8.0), 6.0)
    return site.place()
