"""A car with six cameras drives through a junction in moving traffic."""

from __future__ import annotations

import math

import numpy as np

from ..imaging import Imaging
from ..motion import Path, Waypoint, standing
from ..rig import CameraMount, mount
from ..scene import Environment, Scene
from ..scenery import Lane, build_place
from ..scenery.junction import junction_plan
from ..traffic import Look, TrafficPlan, passing, turning
from .crowd import LONG_KINDS, draw_wardrobe

RATE_HZ = 12.0
SIZE_PX = (960, 540)
NARROW_PX = 985.0
WIDE_PX = 465.0
"""Focal lengths: 52 degrees ahead, 92 to the other sides, so that neighbours overlap."""
EGO_SPEED_M_PER_S = 8.5
START_M = -52.0
ROAD_END_M = 190.0
CLEAN_IMAGING = Imaging(noise=0.7, blur_px=0.35)
"""A good camera by daylight: most of a clip's bytes are spent on noise."""
PLACES_TRIED = 400
SHORTEST_PLAN_S = 10.0
"""Traffic is planned for at least so long, so that a short run is the beginning of a longer one."""
BUILT_UP = ("town", "mixed", "house", "tower")


def six_cameras() -> tuple[CameraMount, ...]:
    """Cameras on the roof of a car, fired one after another as a sweep around it would have them."""
    return (
        mount("front_left", SIZE_PX, WIDE_PX, (1.5, 0.6, 1.9), yaw_deg=56.0, delay_s=0.039),
        mount("front", SIZE_PX, NARROW_PX, (0.9, 0.0, 2.1), delay_s=0.050),
        mount("front_right", SIZE_PX, WIDE_PX, (1.5, -0.6, 1.9), yaw_deg=-56.0, delay_s=0.061),
        mount("right", SIZE_PX, WIDE_PX, (0.6, -0.7, 1.9), yaw_deg=-110.0, delay_s=0.078),
        mount("back", SIZE_PX, WIDE_PX, (-0.3, 0.0, 2.0), yaw_deg=180.0, pitch_deg=1.0, delay_s=0.0),
        mount("left", SIZE_PX, WIDE_PX, (0.6, 0.7, 1.9), yaw_deg=110.0, delay_s=0.018),
    )


def traffic(seed: int, frames: int) -> Scene:
    """Oncoming, crossing, turning, overtaking and parked vehicles and people around a moving rig."""
    rng = np.random.default_rng([seed, 61])
    place_seed = _place_seed(rng)
    environment = Environment(
        "junction", place_seed, str(rng.choice(["sun", "sun", "overcast"])),
        sun_azimuth_deg=round(float(rng.uniform(-180, 180)), 1),
        sun_elevation_deg=round(float(rng.uniform(25, 60)), 1),
    )  # fmt: skip
    place = build_place("junction", place_seed)
    duration_s = max(frames / RATE_HZ, SHORTEST_PLAN_S) + 0.2
    roads = _Roads(place_seed)
    ego_y = roads.lane_y(0)
    end_m = START_M + EGO_SPEED_M_PER_S * duration_s
    ego = Path((Waypoint(0.0, START_M, ego_y), Waypoint(duration_s, end_m, ego_y)))
    planner = _Planner(TrafficPlan(place, ego, duration_s), roads, rng)
    planner.fill()
    return Scene(
        frames=frames, rate_hz=RATE_HZ, cameras=six_cameras(), objects=tuple(planner.plan.objects), seed=seed,
        environment=environment, imaging=CLEAN_IMAGING, ego=ego,
    )  # fmt: skip


def _place_seed(rng: np.random.Generator) -> int:
    """A junction whose main road has two lanes each way, so that others can overtake, with parked cars.

    It has no signals: they would have to change for the crossing traffic.
    """
    for _ in range(PLACES_TRIED):
        seed = int(rng.integers(1 << 30))
        plan = junction_plan(seed)
        roads = (plan.along_x, plan.along_y)
        fits = roads[0].lanes_each_way == 2 and roads[1].lanes_each_way < 3 and not plan.has_signals
        if fits and roads[0].style in BUILT_UP and any(road.parking == "parallel" for road in roads):
            return seed
    return seed


class _Roads:
    """The two roads of a junction as lines to drive on; positions follow traffic that keeps to the right."""

    def __init__(self, place_seed: int) -> None:
        plan = junction_plan(place_seed)
        self.along_x, self.along_y = plan.along_x, plan.along_y

    def lane_y(self, from_kerb: int) -> float:
        """The y of a lane of the x road towards +x, counted from the kerb inwards."""
        return -self._offset(self.along_x, from_kerb)

    def eastward(self, from_kerb: int):
        """From end to end of the x road, towards +x."""
        y = self.lane_y(from_kerb)
        return (-ROAD_END_M, y), (ROAD_END_M, y)

    def westward(self, from_kerb: int):
        """Towards -x."""
        y = -self.lane_y(from_kerb)
        return (ROAD_END_M, y), (-ROAD_END_M, y)

    def northward(self, from_kerb: int):
        """Along the y road, towards +y."""
        x = self._offset(self.along_y, from_kerb)
        return (x, -ROAD_END_M), (x, ROAD_END_M)

    def southward(self, from_kerb: int):
        """Towards -y."""
        x = -self._offset(self.along_y, from_kerb)
        return (x, ROAD_END_M), (x, -ROAD_END_M)

    @staticmethod
    def _offset(section, from_kerb: int) -> float:
        lane = max(0, section.lanes_each_way - 1 - from_kerb)
        return 0.5 * section.median_m + (lane + 0.5) * section.lane_width_m


class _Planner:
    """Fills a traffic plan kind by kind, the things that matter most first."""

    def __init__(self, plan: TrafficPlan, roads: _Roads, rng: np.random.Generator) -> None:
        self.plan = plan
        self._roads = roads
        self._rng = rng
        self._wardrobe = draw_wardrobe(int(rng.integers(1 << 30)), vehicles=40, riders=6, people=14)

    def fill(self) -> None:
        """Proposes everything; what does not fit is left out."""
        self._with_the_ego()
        self._cyclists(9)
        self._oncoming(12)
        self._crossing(14)
        self._turning(5)
        self._parked(0.75)
        self._people(80)

    def _one_of(self, looks: tuple[Look, ...]) -> Look:
        return looks[int(self._rng.integers(len(looks)))]

    def _drive(self, line, along_m: float, speed: float) -> bool:
        path = passing(*line, along_m, speed, self.plan.duration_s)
        return path is not None and self.plan.propose(self._one_of(self._wardrobe.vehicles), path)

    def _with_the_ego(self) -> None:
        """One ahead, one behind, and others that overtake in the inner lane, from camera to camera."""
        start = START_M + ROAD_END_M
        rng = self._rng
        self._drive(self._roads.eastward(0), start + rng.uniform(17.0, 24.0), EGO_SPEED_M_PER_S)
        self._drive(self._roads.eastward(0), start - rng.uniform(14.0, 18.0), EGO_SPEED_M_PER_S)
        for behind in (6.0, 24.0, 45.0, -22.0):
            faster = EGO_SPEED_M_PER_S + (4.0 if behind > 0 else -1.5) + rng.uniform(-0.4, 0.4)
            self._drive(self._roads.eastward(1), start - behind - rng.uniform(0.0, 6.0), faster)

    def _oncoming(self, count: int) -> None:
        rng = self._rng
        for _ in range(count):
            line = self._roads.westward(int(rng.integers(2)))
            self._drive(line, ROAD_END_M + rng.uniform(-110.0, 60.0), rng.uniform(6.0, 10.0))

    def _crossing(self, count: int) -> None:
        rng = self._rng
        for _ in range(count):
            line = self._roads.northward(0) if rng.random() < 0.5 else self._roads.southward(0)
            self._drive(line, ROAD_END_M + rng.uniform(-75.0, 35.0), rng.uniform(6.0, 9.0))

    def _turning(self, count: int) -> None:
        """Oncoming vehicles that turn right, and some from the side road that turn right into it."""
        roads, rng = self._roads, self._rng
        for _ in range(count):
            at_s = float(rng.uniform(0.5, self.plan.duration_s - 1.0))
            westward_y, northward_x = roads.westward(0)[0][1], roads.northward(0)[0][0]
            southward_x, reach = roads.southward(0)[0][0], 9.0
            if rng.random() < 0.5:
                ends = (northward_x + reach, westward_y), (northward_x, westward_y + reach)
                path = turning(*ends, math.pi, math.pi / 2, at_s, 5.0, self.plan.duration_s)
            else:
                ends = (southward_x, westward_y + reach), (southward_x - reach, westward_y)
                path = turning(*ends, -math.pi / 2, math.pi, at_s, 5.0, self.plan.duration_s)
            self.plan.propose(self._one_of(self._wardrobe.vehicles), path)

    def _parked(self, share: float) -> None:
        rng = self._rng
        for bay in self.plan.place.layout.bays:
            look = self._one_of(self._wardrobe.vehicles)
            if rng.random() > share or look.kind in LONG_KINDS or math.hypot(bay.x_m, bay.y_m) > 80.0:
                continue
            self.plan.propose(look, standing(bay.x_m, bay.y_m, bay.yaw_rad + rng.normal(0.0, 0.02)))

    def _cyclists(self, count: int) -> None:
        rng, roads = self._rng, self._roads
        for _ in range(count):
            line = (roads.westward, roads.northward, roads.southward, roads.eastward)[int(rng.integers(4))](0)
            right = _shifted(line, -1.0)
            along_m, speed = ROAD_END_M + rng.uniform(-60.0, 30.0), rng.uniform(3.5, 5.5)
            path = passing(*right, along_m, speed, self.plan.duration_s)
            if path is not None:
                self.plan.propose(self._one_of(self._wardrobe.riders), path)

    def _people(self, count: int) -> None:
        rng, layout = self._rng, self.plan.place.layout
        near = [walk for walk in layout.walks if math.hypot(*walk.at(0.5 * walk.length_m)) < 90.0]
        for index in range(count):
            strips = layout.crossings if index % 4 == 0 else near
            self._pedestrian(strips[int(rng.integers(len(strips)))])

    def _pedestrian(self, strip: Lane) -> None:
        rng = self._rng
        left = float(rng.uniform(-0.5, 0.5) * strip.width_m)
        line = (strip.at(0.0, left), strip.at(strip.length_m, left))
        if rng.random() < 0.5:
            line = line[::-1]
        speed = float(rng.uniform(0.9, 1.6))
        path = passing(*line, float(rng.uniform(0.0, min(60.0, strip.length_m))), speed, self.plan.duration_s)
        if path is not None:
            self.plan.propose(self._one_of(self._wardrobe.people), path)


def _shifted(line, left_m: float):
    """The line, moved to the left of its direction."""
    (x0, y0), (x1, y1) = line
    yaw = math.atan2(y1 - y0, x1 - x0)
    dx, dy = -left_m * math.sin(yaw), left_m * math.cos(yaw)
    return (x0 + dx, y0 + dy), (x1 + dx, y1 + dy)
