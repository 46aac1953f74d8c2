"""Plans moving traffic: proposed routes are kept only where nothing touches anything at any time."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from .motion import Path, Waypoint
from .scene import SceneObject
from .scenery import Footprint, Place

STEP_S = 0.2
"""Paths are compared this often: at town speeds things move 2 m in it, less than half a car."""
CLEARANCE_M = 0.5
EGO_SIZE_M = (4.8, 2.0)


@dataclass(frozen=True)
class Look:
    """One thing of the catalogue, without its place."""

    kind: str
    seed: int


@dataclass(frozen=True)
class Track:
    """Where a footprint is over time: x, y (m) and yaw (rad) as an array (times, 3), and its size (m)."""

    poses: np.ndarray
    length_m: float
    width_m: float

    @property
    def radius_m(self) -> float:
        """Of the circle around the footprint."""
        return 0.5 * math.hypot(self.length_m, self.width_m)

    def footprint(self, step: int) -> Footprint:
        """At one of the times."""
        x, y, yaw = (float(value) for value in self.poses[step])
        return Footprint(x, y, yaw, self.length_m, self.width_m)

    def meets(self, other: Track) -> bool:
        """Whether the two touch at any time."""
        apart = np.linalg.norm(self.poses[:, :2] - other.poses[:, :2], axis=1)
        near = np.flatnonzero(apart < self.radius_m + other.radius_m)
        return any(self.footprint(step).overlaps(other.footprint(step)) for step in near)

    def hits(self, obstacle: Footprint) -> bool:
        """Whether it touches something that stands, at any time."""
        reach = self.radius_m + 0.5 * math.hypot(obstacle.length_m, obstacle.width_m)
        apart = np.linalg.norm(self.poses[:, :2] - [obstacle.x_m, obstacle.y_m], axis=1)
        return any(self.footprint(step).overlaps(obstacle) for step in np.flatnonzero(apart < reach))


@dataclass
class TrafficPlan:
    """Things accepted so far, over `duration_s`, around the ego vehicle's own path."""

    place: Place
    ego: Path
    duration_s: float
    objects: list[SceneObject] = field(default_factory=list)
    _tracks: list[Track] = field(default_factory=list)

    def __post_init__(self) -> None:
        self._tracks.append(self._track(self.ego, *EGO_SIZE_M))

    def propose(self, look: Look, path: Path) -> bool:
        """Adds a thing on a path unless it would touch another, the ego vehicle, or street furniture."""
        thing = SceneObject(f"{look.kind} {len(self.objects) + 1}", look.kind, look.seed, path)
        length, width, _ = thing.model.size_lwh_m
        track = self._track(path, length + CLEARANCE_M, width + CLEARANCE_M)
        if any(track.meets(other) for other in self._tracks):
            return False
        if any(track.hits(obstacle) for obstacle in self.place.layout.obstacles):
            return False
        self.objects.append(thing)
        self._tracks.append(track)
        return True

    def _track(self, path: Path, length_m: float, width_m: float) -> Track:
        times = np.arange(0.0, self.duration_s + STEP_S, STEP_S)
        poses = [path.at(float(time)) for time in times]
        return Track(np.array([(at.x_m, at.y_m, at.yaw_rad) for at in poses]), length_m, width_m)


def passing(
    start: tuple[float, float], end: tuple[float, float], along_m: float, speed_m_per_s: float,
    duration_s: float,
) -> Path | None:
    """Steady movement along a line, `along_m` from its start at time 0; None where it runs past the end."""
    length = math.dist(start, end)
    reach = along_m + speed_m_per_s * duration_s
    if not 0.0 <= along_m <= length or reach > length:
        return None

    def at(distance: float) -> tuple[float, float]:
        share = distance / length
        return (start[0] + share * (end[0] - start[0]), start[1] + share * (end[1] - start[1]))

    return Path((Waypoint(0.0, *at(along_m)), Waypoint(duration_s, *at(reach))))


def turning(
    entry: tuple[float, float], exit_: tuple[float, float], entry_yaw: float, exit_yaw: float, at_s: float,
    speed_m_per_s: float, duration_s: float,
) -> Path:
    """Movement at one speed that enters a bend at `entry`, at the time `at_s`, and leaves it at `exit_`."""
    bend = _bend(np.array(entry), np.array(exit_), entry_yaw, exit_yaw)
    along = np.append(0.0, np.cumsum(np.linalg.norm(np.diff(bend, axis=0), axis=1)))
    before = np.array([math.cos(entry_yaw), math.sin(entry_yaw)])
    after = np.array([math.cos(exit_yaw), math.sin(exit_yaw)])
    points = [(at_s - back / speed_m_per_s, bend[0] - back * before) for back in (60.0, 30.0, 12.0, 4.0)]
    points += [(at_s + far / speed_m_per_s, place) for far, place in zip(along, bend, strict=True)]
    left_s = at_s + along[-1] / speed_m_per_s
    points += [(left_s + far / speed_m_per_s, bend[-1] + far * after) for far in (4.0, 12.0, 30.0, 60.0)]
    waypoints = [Waypoint(float(time), float(x), float(y)) for time, (x, y) in points]
    if waypoints[-1].time_s < duration_s:
        far = speed_m_per_s * (duration_s - left_s) + 1.0
        last = bend[-1] + far * after
        waypoints.append(Waypoint(left_s + far / speed_m_per_s, float(last[0]), float(last[1])))
    return Path(tuple(waypoints))


def _bend(
    entry: np.ndarray, exit_: np.ndarray, entry_yaw: float, exit_yaw: float, count: int = 14
) -> np.ndarray:
    """A quadratic curve whose ends point along the two directions: its handle is where their lines meet."""
    first = np.array([math.cos(entry_yaw), math.sin(entry_yaw)])
    second = np.array([math.cos(exit_yaw), math.sin(exit_yaw)])
    along, _ = np.linalg.solve(np.stack([first, second], 1), exit_ - entry)
    handle = entry + along * first
    share = np.linspace(0.0, 1.0, count)[:, None]
    return (1 - share) ** 2 * entry + 2 * share * (1 - share) * handle + share**2 * exit_
