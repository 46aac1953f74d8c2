"""Fills a place with standing things, none inside another: bays, lanes, pavements, crossings."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from ..motion import standing
from ..scene import SceneObject
from ..scenery import Footprint, Lane, Place
from ..traffic import Look

CLEARANCE_M = 0.25
"""Between the cuboids of any two things: mirrors stand out of them."""
VEHICLE_SHARES = {
    "sedan": 0.21, "compact": 0.17, "suv": 0.18, "wagon": 0.09, "minivan": 0.07, "pickup": 0.07,
    "sports": 0.04,
    "van": 0.08, "truck": 0.05, "bus": 0.04,
}  # fmt: skip
LONG_KINDS = ("bus", "truck")


@dataclass(frozen=True)
class Wardrobe:
    """A limited set of looks that images near each other share, since building a model takes its time."""

    vehicles: tuple[Look, ...]
    riders: tuple[Look, ...]
    people: tuple[Look, ...]


def draw_wardrobe(seed: int, vehicles: int = 26, riders: int = 5, people: int = 11) -> Wardrobe:
    """Looks drawn by the shares in which kinds are seen on streets."""
    rng = np.random.default_rng([seed, 31])
    kinds = rng.choice(list(VEHICLE_SHARES), vehicles, p=list(VEHICLE_SHARES.values()))

    def looks(names) -> tuple[Look, ...]:
        return tuple(Look(str(name), int(rng.integers(1 << 30))) for name in names)

    two_wheels = rng.choice(["bicycle", "motorcycle"], riders, p=[0.65, 0.35])
    return Wardrobe(looks(kinds), looks(two_wheels), looks(["pedestrian"] * people))


@dataclass
class Crowd:
    """Things placed so far. `eye` is kept clear, and nothing stands beyond `reach_m` of it."""

    place: Place
    wardrobe: Wardrobe
    rng: np.random.Generator
    eye: Footprint
    reach_m: float
    view_yaw_rad: float = 0.0
    view_half_rad: float = math.pi
    most: int = 60
    objects: list[SceneObject] = field(default_factory=list)
    _taken: list[Footprint] = field(default_factory=list)

    def place_one(self, look: Look, x_m: float, y_m: float, yaw_rad: float) -> bool:
        """Stands a thing somewhere; false where it is out of view, too close, or in the way."""
        if len(self.objects) >= self.most or not self._is_in_view(x_m, y_m):
            return False
        name = f"{look.kind} {len(self.objects) + 1}"
        thing = SceneObject(name, look.kind, look.seed, standing(x_m, y_m, yaw_rad))
        length, width, _ = thing.model.size_lwh_m
        print_ = Footprint(x_m, y_m, yaw_rad, length + CLEARANCE_M, width + CLEARANCE_M)
        if print_.overlaps(self.eye) or any(print_.overlaps(other) for other in self._taken):
            return False
        if any(print_.overlaps(other) for other in self.place.layout.obstacles):
            return False
        self._taken.append(print_)
        self.objects.append(thing)
        return True

    def park(self, share: float) -> None:
        """Fills a share of the bays, some noses in, some out."""
        rng = self.rng
        for bay in self.place.layout.bays:
            if rng.random() > share or not self._is_in_view(bay.x_m, bay.y_m):
                continue
            look = self._vehicle(longest=False)
            flip = math.pi if rng.random() < (0.3 if bay.width_m > 2.3 else 0.08) else 0.0
            offset = rng.normal(0.0, 0.12, 2)
            yaw = bay.yaw_rad + flip + rng.normal(0.0, 0.025)
            self.place_one(look, bay.x_m + offset[0], bay.y_m + offset[1], yaw)

    def drive(self, gap_m: float) -> None:
        """Puts traffic on the lanes, on average so far apart, with queues here and there."""
        rng = self.rng
        for lane in self.place.layout.lanes:
            along = float(rng.exponential(gap_m))
            while along < lane.length_m:
                look = self._rider() if rng.random() < 0.07 else self._vehicle()
                left = rng.normal(0.0, 0.2) - (0.3 * lane.width_m if look.kind == "bicycle" else 0.0)
                self.place_one(look, *lane.at(along, left), lane.yaw_rad + rng.normal(0.0, 0.03))
                step = 6.5 if rng.random() < 0.35 else rng.exponential(gap_m)
                along += 2.0 + float(step)

    def walk(self, gap_m: float) -> None:
        """Puts people on pavements and crossings, alone and in groups."""
        layout = self.place.layout
        for strip in layout.walks:
            self._people_along(strip, gap_m)
        for strip in layout.crossings:
            self._people_along(strip, 0.6 * gap_m)

    def scatter(self, vehicles: int, people: int) -> None:
        """Puts things on open road at any heading."""
        rng = self.rng
        for count, pick in ((vehicles, self._vehicle), (people, self._person)):
            for _ in range(count):
                distance = rng.uniform(4.0, min(self.reach_m, 45.0))
                angle = self.view_yaw_rad + rng.uniform(-1.0, 1.0) * min(self.view_half_rad, math.pi)
                x, y = self.eye.x_m + distance * math.cos(angle), self.eye.y_m + distance * math.sin(angle)
                look = self._rider() if pick == self._vehicle and rng.random() < 0.2 else pick()
                if self._is_level(look, x, y):
                    self.place_one(look, x, y, rng.uniform(-math.pi, math.pi))

    def _people_along(self, strip: Lane, gap_m: float) -> None:
        rng = self.rng
        along = float(rng.exponential(gap_m))
        while along < strip.length_m:
            for _ in range(int(rng.choice([1, 1, 1, 2, 2, 3, 5]))):
                yaw = strip.yaw_rad + math.pi * rng.integers(2) + rng.normal(0.0, 0.25)
                yaw = rng.uniform(-math.pi, math.pi) if rng.random() < 0.25 else yaw
                at = strip.at(along + rng.normal(0.0, 0.5), rng.uniform(-0.5, 0.5) * strip.width_m)
                self.place_one(self._rider() if rng.random() < 0.08 else self._person(), *at, yaw)
            along += 1.0 + float(rng.exponential(gap_m))

    def _is_in_view(self, x: float, y: float) -> bool:
        dx, dy = x - self.eye.x_m, y - self.eye.y_m
        distance = math.hypot(dx, dy)
        off = abs(math.remainder(math.atan2(dy, dx) - self.view_yaw_rad, 2.0 * math.pi))
        slack = math.atan2(3.0, max(distance, 0.1))
        return distance < self.reach_m and off < self.view_half_rad + slack

    def _is_level(self, look: Look, x: float, y: float) -> bool:
        """Whether the ground is road under the whole thing, whatever its heading."""
        length, width, _ = SceneObject("", look.kind, look.seed, standing(0, 0, 0)).model.size_lwh_m
        radius = 0.5 * math.hypot(length, width)
        layout = self.place.layout
        directions = ((1, 0), (-1, 0), (0, 1), (0, -1), (0, 0))
        around = [(x + radius * cos, y + radius * sin) for cos, sin in directions]
        return all(layout.height_m(*point) == 0.0 and layout.is_road(*point) for point in around)

    def _vehicle(self, *, longest: bool = True) -> Look:
        options = self.wardrobe.vehicles
        if not longest:
            options = [look for look in options if look.kind not in LONG_KINDS]
        return options[int(self.rng.integers(len(options)))]

    def _rider(self) -> Look:
        return self.wardrobe.riders[int(self.rng.integers(len(self.wardrobe.riders)))]

    def _person(self) -> Look:
        return self.wardrobe.people[int(self.rng.integers(len(self.wardrobe.people)))]
