"""Where things may stand and move in a place: lanes, bays, pavements, and what is in the way."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from ..model import Instance


@dataclass(frozen=True)
class Lane:
    """A straight lane from `start` to `end` (x, y in metres, world), in its direction of travel."""

    start: tuple[float, float]
    end: tuple[float, float]
    width_m: float

    @property
    def yaw_rad(self) -> float:
        """Direction of travel."""
        return math.atan2(self.end[1] - self.start[1], self.end[0] - self.start[0])

    @property
    def length_m(self) -> float:
        """From start to end."""
        return math.dist(self.start, self.end)

    def at(self, along_m: float, left_m: float = 0.0) -> tuple[float, float]:
        """The place so far along the lane and so far to the left of its middle."""
        cos, sin = math.cos(self.yaw_rad), math.sin(self.yaw_rad)
        return (self.start[0] + along_m * cos - left_m * sin, self.start[1] + along_m * sin + left_m * cos)


@dataclass(frozen=True)
class Bay:
    """A parking bay: its middle (m, world), the direction in which a car in it points, its size."""

    x_m: float
    y_m: float
    yaw_rad: float
    length_m: float
    width_m: float


@dataclass(frozen=True)
class Footprint:
    """A rectangle on the ground: middle (m, world), direction of its length, length and width."""

    x_m: float
    y_m: float
    yaw_rad: float
    length_m: float
    width_m: float

    def corners(self) -> np.ndarray:
        """The four corners (4, 2), counter-clockwise."""
        cos, sin = math.cos(self.yaw_rad), math.sin(self.yaw_rad)
        along = 0.5 * self.length_m * np.array([cos, sin])
        across = 0.5 * self.width_m * np.array([-sin, cos])
        middle = np.array([self.x_m, self.y_m])
        return np.array([middle - along - across, middle + along - across, middle + along + across,
                         middle - along + across])

    def overlaps(self, other: Footprint) -> bool:
        """Whether the two rectangles share any area (separating axes)."""
        reach = 0.5 * (math.hypot(self.length_m, self.width_m) + math.hypot(other.length_m, other.width_m))
        if math.hypot(self.x_m - other.x_m, self.y_m - other.y_m) >= reach:
            return False
        mine, theirs = self.corners(), other.corners()
        for yaw in (self.yaw_rad, self.yaw_rad + math.pi / 2, other.yaw_rad, other.yaw_rad + math.pi / 2):
            axis = np.array([math.cos(yaw), math.sin(yaw)])
            here, there = mine @ axis, theirs @ axis
            if here.max() <= there.min() or there.max() <= here.min():
                return False
        return True


@dataclass(frozen=True)
class Raised:
    """Ground above the road: a rectangle (x_min, y_min, x_max, y_max; m, world) and its height (m)."""

    box: tuple[float, float, float, float]
    height_m: float


@dataclass
class Layout:
    """What a place offers to traffic."""

    lanes: list[Lane] = field(default_factory=list)
    bays: list[Bay] = field(default_factory=list)
    walks: list[Lane] = field(default_factory=list)
    crossings: list[Lane] = field(default_factory=list)
    obstacles: list[Footprint] = field(default_factory=list)
    raised: list[Raised] = field(default_factory=list)
    roads: list[tuple[float, float, float, float]] = field(default_factory=list)
    """Rectangles of road: x_min, y_min, x_max, y_max (m, world)."""

    def is_road(self, x_m: float, y_m: float) -> bool:
        """Whether there is road at a place."""
        return any(x0 <= x_m <= x1 and y0 <= y_m <= y1 for x0, y0, x1, y1 in self.roads)

    def height_m(self, x_m: float, y_m: float) -> float:
        """Height of the ground at a place."""
        for raised in self.raised:
            x_min, y_min, x_max, y_max = raised.box
            if x_min <= x_m <= x_max and y_min <= y_m <= y_max:
                return raised.height_m
        return 0.0


@dataclass(frozen=True)
class Place:
    """A built environment: what is drawn, and what traffic needs to know of it."""

    kind: str
    instances: tuple[Instance, ...]
    layout: Layout
