"""How things move on the ground: timed places, joined smoothly."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.interpolate import PchipInterpolator

STANDING_M_PER_S = 0.02
"""Below this speed a thing keeps the direction in which it last moved."""


@dataclass(frozen=True)
class Waypoint:
    """A place (m, world) at a time (s).

    Without `yaw_rad` the direction follows from the movement. Given directions are joined as numbers: from
    350 to 370 degrees is a turn by 20 to the left, from 350 to 10 one by 340 to the right.
    """

    time_s: float
    x_m: float
    y_m: float
    yaw_rad: float | None = None


@dataclass(frozen=True)
class GroundPose:
    """A place on the ground (m, world) and a direction."""

    x_m: float
    y_m: float
    yaw_rad: float


@dataclass(frozen=True)
class Path:
    """Waypoints in order of time; before the first and after the last the thing stands still."""

    waypoints: tuple[Waypoint, ...]

    @property
    def is_moving(self) -> bool:
        """Whether the place or direction ever changes."""
        first = self.waypoints[0]
        return any((w.x_m, w.y_m, w.yaw_rad) != (first.x_m, first.y_m, first.yaw_rad) for w in self.waypoints)

    def at(self, time_s: float) -> GroundPose:
        """Where the thing is, and its direction, at a time."""
        if len(self.waypoints) == 1:
            only = self.waypoints[0]
            return GroundPose(only.x_m, only.y_m, only.yaw_rad or 0.0)
        time_s = min(max(time_s, self.waypoints[0].time_s), self.waypoints[-1].time_s)
        x, y = (float(value) for value in self._place(time_s))
        return GroundPose(x, y, self._yaw(time_s))

    @cached_property
    def _place(self) -> PchipInterpolator:
        times = [waypoint.time_s for waypoint in self.waypoints]
        return PchipInterpolator(times, [(waypoint.x_m, waypoint.y_m) for waypoint in self.waypoints])

    @cached_property
    def _velocity(self) -> PchipInterpolator:
        return self._place.derivative()

    def _yaw(self, time_s: float) -> float:
        if all(waypoint.yaw_rad is not None for waypoint in self.waypoints):
            times = [waypoint.time_s for waypoint in self.waypoints]
            return float(np.interp(time_s, times, [waypoint.yaw_rad for waypoint in self.waypoints]))
        velocity = self._velocity(time_s)
        if math.hypot(*velocity) > STANDING_M_PER_S:
            return math.atan2(velocity[1], velocity[0])
        return self._standing_yaw(time_s)

    def _standing_yaw(self, time_s: float) -> float:
        """The direction of the last movement before, else of the first after."""
        steps = list(zip(self.waypoints[:-1], self.waypoints[1:], strict=True))
        before = [step for step in reversed(steps) if step[0].time_s <= time_s]
        after = [step for step in steps if step[0].time_s > time_s]
        for start, end in (*before, *after):
            if math.hypot(end.x_m - start.x_m, end.y_m - start.y_m) > 1e-6:
                return math.atan2(end.y_m - start.y_m, end.x_m - start.x_m)
        return self.waypoints[0].yaw_rad or 0.0


def standing(x_m: float, y_m: float, yaw_rad: float) -> Path:
    """A thing that stays where it is."""
    return Path((Waypoint(0.0, x_m, y_m, yaw_rad),))


def straight(
    start: tuple[float, float], end: tuple[float, float], begin_s: float, speed_m_per_s: float
) -> Path:
    """A thing that goes from `start` to `end` at one speed."""
    duration = math.dist(start, end) / speed_m_per_s
    return Path((Waypoint(begin_s, *start), Waypoint(begin_s + duration, *end)))
