"""Paths along straights and bends, with a speed at every metre, whose direction never jumps."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..motion import Path, Waypoint

GRAIN_M = 0.05
"""Courses are summed up in steps of this length."""
EASE_M = 3.0
"""A bend takes so long to reach its full curvature, as steering does."""
STEP_S = 0.1
"""Between two waypoints."""
Speeds = float | Sequence[tuple[float, float]]
"""One speed (m/s), or pairs of a distance along the course (m) and the speed there, joined evenly."""


@dataclass(frozen=True)
class Leg:
    """A piece of a course: straight, or an arc that turns by an angle (to the left) over its length."""

    length_m: float
    turn_rad: float = 0.0


def bend(radius_m: float, turn_rad: float) -> Leg:
    """An arc of that radius."""
    return Leg(radius_m * abs(turn_rad), turn_rad)


def course(
    start: tuple[float, float], yaw_rad: float, legs: Sequence[Leg], speeds: Speeds, duration_s: float
) -> Path:
    """Movement from `start` at time 0 over the legs, and straight on after them, for `duration_s`."""
    pairs = ((0.0, speeds),) if isinstance(speeds, float | int) else speeds
    reach = max(speed for _, speed in pairs) * duration_s + EASE_M
    along, x, y, yaw = _line([*legs, Leg(reach)])
    speed = np.interp(along, *np.array(pairs, dtype=float).T)
    times = np.append(0.0, np.cumsum(GRAIN_M / (0.5 * (speed[:-1] + speed[1:]))))
    cos, sin = math.cos(yaw_rad), math.sin(yaw_rad)
    waypoints = []
    for moment in np.arange(0.0, duration_s + STEP_S, STEP_S):
        ahead, left, turned = (float(np.interp(moment, times, values)) for values in (x, y, yaw))
        place = (start[0] + ahead * cos - left * sin, start[1] + ahead * sin + left * cos)
        waypoints.append(Waypoint(float(moment), *place, yaw_rad + turned))
    return Path(tuple(waypoints))


def displacement(legs: Sequence[Leg]) -> tuple[float, float]:
    """How far ahead and to the left of their start the legs end, once their last bend is over."""
    along, x, y, yaw = _line([*legs, Leg(EASE_M)])
    back = along[-1] - sum(leg.length_m for leg in legs)
    return (float(x[-1] - back * math.cos(yaw[-1])), float(y[-1] - back * math.sin(yaw[-1])))


def _line(legs: Sequence[Leg]) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Distance along the legs, x, y and direction, from the origin along x; bends begin and end gently."""
    ends = np.cumsum([leg.length_m for leg in legs])
    middles = np.arange(0.5 * GRAIN_M, ends[-1], GRAIN_M)
    curvature = np.array([leg.turn_rad / leg.length_m for leg in legs])[np.searchsorted(ends, middles)]
    window = round(EASE_M / GRAIN_M)
    curvature = np.convolve(np.pad(curvature, window, mode="edge"), np.ones(window) / window, mode="same")
    curvature = curvature[window:-window]
    yaw = np.append(0.0, np.cumsum(curvature) * GRAIN_M)
    mean = 0.5 * (yaw[:-1] + yaw[1:])
    x = np.append(0.0, np.cumsum(np.cos(mean)) * GRAIN_M)
    y = np.append(0.0, np.cumsum(np.sin(mean)) * GRAIN_M)
    return np.arange(len(yaw)) * GRAIN_M, x, y, yaw
