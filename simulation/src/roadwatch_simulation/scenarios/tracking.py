"""Few things around a car with six cameras, each scene for one thing that tracking has to get right."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from ..motion import Path, standing
from ..scene import Scene, SceneObject
from ..scenery import build_place
from ..scenery.junction import CORNER_M, CROSSING_M, JunctionPlan, junction_plan
from ..scenery.section import Section
from ..scenery.street import street_section
from ..traffic import EGO_SIZE_M
from .course import Leg, bend, course, displacement
from .stage import Misfit, Stage, seed_where, set_up, staged

HANDOVER_FRAMES = 100
"""Once around takes a little longer."""
HIDDEN_S = {"parked": 1.15, "moving": 1.6}
"""So long the bus covers the whole of each car."""
BEND_M_PER_S2 = 4.0
"""Sideways, in a tight turn."""
BUS_AHEAD_M, CAR_AHEAD_M, PARKED_AHEAD_M = 13.0, 19.0, 24.0


def crossing(seed: int, frames: int) -> Scene:
    """Vehicles cross before the waiting rig from left and right; the first two pass each other there."""
    return staged(_crossing, seed, frames)


def _crossing(rng: np.random.Generator, duration_s: float) -> Stage:
    place_seed, plan = _junction(
        lambda plan: plan.along_x.lanes_each_way == plan.along_y.lanes_each_way == 1, rng
    )
    ego_y, aside = -_lane(plan.along_x, 0), _lane(plan.along_y, 0)
    before = plan.along_y.kerb_line_m + CORNER_M + CROSSING_M + 0.5 + 0.5 * EGO_SIZE_M[0]
    stage = set_up("junction", place_seed, rng, standing(-before, ego_y, 0.0), duration_s)
    met_s = float(rng.uniform(2.6, 3.2))
    southward, northward = (-aside, ego_y, -math.pi / 2), (aside, ego_y, math.pi / 2)
    speeds = rng.uniform(7.0, 9.5, 2).tolist()
    for late_s in (-0.2, 3.0):
        stage.put_car(_passing(southward, speeds[0], met_s + late_s, duration_s))
    for late_s in (0.2, 4.0):
        stage.put_car(_passing(northward, speeds[1], met_s + late_s, duration_s))
    return stage


def overtaking(seed: int, frames: int) -> Scene:
    """One car passes the rig on its left, from camera to camera; the rig passes another on its right."""
    return staged(_overtaking, seed, frames)


def _overtaking(rng: np.random.Generator, duration_s: float) -> Stage:
    place_seed = seed_where(lambda seed: street_section(seed).lanes_each_way == 3, rng)
    left, own, right = (-_lane(street_section(place_seed), lane) for lane in range(3))
    ego_x, speed = -30.0, 8.0
    ego = _passing((ego_x, own, 0.0), speed, 0.0, duration_s)
    stage = set_up("street", place_seed, rng, ego, duration_s)
    others = (
        (ego_x - rng.uniform(16.0, 19.0), left, 0.0, rng.uniform(12.5, 13.5)),
        (ego_x + rng.uniform(15.0, 18.0), right, 0.0, rng.uniform(3.6, 4.2)),
        (ego_x + rng.uniform(24.0, 30.0), own, 0.0, speed),
        (rng.uniform(50.0, 60.0), -left, math.pi, rng.uniform(8.0, 10.0)),
    )
    for x, y, yaw, other_speed in others:
        stage.put_car(_passing((float(x), y, yaw), float(other_speed), 0.0, duration_s))
    return stage


def occlusion(seed: int, frames: int) -> Scene:
    """A bus passes between the standing rig and two cars, a moving and a parked one, and hides each."""
    return staged(_occlusion, seed, frames, at_once=True)


def _occlusion(rng: np.random.Generator, duration_s: float) -> Stage:
    """Lengths and speeds count as seen in the plane of the bus's near side."""
    stage = set_up("plain", int(rng.integers(1 << 30)), rng, standing(0.0, 0.0, 0.0), duration_s)
    side = float(rng.choice([-1.0, 1.0]))
    bus, car, parked = stage.look("bus"), *(stage.look("sedan", "suv", "wagon", "compact") for _ in range(2))
    (bus_m, bus_width, _), (car_m, car_width, _), (parked_m, parked_width, _) = (
        SceneObject("", look.kind, look.seed, standing(0.0, 0.0, 0.0)).model.size_lwh_m
        for look in (bus, car, parked)
    )
    near = BUS_AHEAD_M - 0.5 * bus_width
    bus_speed = (bus_m - parked_m * near / (PARKED_AHEAD_M - 0.5 * parked_width)) / HIDDEN_S["parked"]
    left_behind = (bus_m - car_m * near / (CAR_AHEAD_M - 0.5 * car_width)) / HIDDEN_S["moving"]
    car_speed = (bus_speed - left_behind) * CAR_AHEAD_M / near
    yaw, met_s = side * math.pi / 2, float(rng.uniform(3.7, 4.1))
    stage.put(bus, _passing((BUS_AHEAD_M, 0.0, yaw), bus_speed, met_s, duration_s))
    stage.put(car, _passing((CAR_AHEAD_M, 0.0, yaw), car_speed, met_s, duration_s))
    turned = float(rng.choice([-1.0, 1.0])) * math.pi / 2
    stage.put(parked, standing(PARKED_AHEAD_M, -side * rng.uniform(1.5, 3.0), turned))
    return stage


def parked_row(seed: int, frames: int) -> Scene:
    """The rig drives at 10 m/s between two rows of parked cars."""
    return staged(_parked_row, seed, frames)


def _parked_row(rng: np.random.Generator, duration_s: float) -> Stage:
    def fits(seed: int) -> bool:
        section = street_section(seed)
        return section.lanes_each_way == 1 and section.parking == "parallel"

    place_seed = seed_where(fits, rng)
    own = (-42.0, -_lane(street_section(place_seed), 0), 0.0)
    stage = set_up("street", place_seed, rng, _passing(own, 10.0, 0.0, duration_s), duration_s)
    stage.park(0.8, (-45.0, 65.0))
    return stage


def u_turn(seed: int, frames: int) -> Scene:
    """A car ahead turns round at a junction and comes back past the slowly driving rig."""
    return staged(_u_turn, seed, frames)


def _u_turn(rng: np.random.Generator, duration_s: float) -> Stage:
    place_seed, plan = _junction(
        lambda plan: plan.along_x.lanes_each_way == 2 and plan.along_x.median_m == 0.0, rng
    )
    own = -_lane(plan.along_x, 1)
    ego = _passing((-24.0, own, 0.0), 3.5, 0.0, duration_s)
    stage = set_up("junction", place_seed, rng, ego, duration_s)
    round_ = _half_turn(-2.0 * own)
    slow = math.sqrt(BEND_M_PER_S2 * round_.length_m / math.pi)
    ahead_m = float(rng.uniform(4.0, 6.0))
    over_m = ahead_m + round_.length_m
    speeds = ((0.0, slow + 1.0), (ahead_m, slow), (over_m, slow), (over_m + 14.0, 8.0))
    start = (-1.0 - ahead_m, own)
    stage.put_car(course(start, 0.0, (Leg(ahead_m), round_), speeds, duration_s))
    stage.park(0.5, (-60.0, 60.0), 45.0)
    return stage


def handover(seed: int, frames: int) -> Scene:
    """A car drives once around the standing rig, through the view of every camera; two others stand."""
    return staged(_handover, seed, frames, least=HANDOVER_FRAMES)


def _handover(rng: np.random.Generator, duration_s: float) -> Stage:
    heading = float(rng.uniform(-math.pi, math.pi))
    ego = standing(0.0, 0.0, heading)
    stage = set_up("plain", int(rng.integers(1 << 30)), rng, ego, duration_s)
    radius, speed = float(rng.uniform(9.3, 9.8)), 6.0
    begin = heading + math.pi + 0.2
    start = (radius * math.cos(begin), radius * math.sin(begin))
    laps = math.ceil(speed * duration_s / (2.0 * math.pi * radius))
    circle = course(start, begin + math.pi / 2, (bend(radius, laps * 2.0 * math.pi),), speed, duration_s)
    stage.put(stage.look("sedan", "compact", "wagon", "suv"), circle)
    for angle in heading + rng.uniform(-0.3, 0.3, 2) + (0.4, 2.3):
        far = float(rng.uniform(17.0, 22.0))
        yaw = float(rng.uniform(-math.pi, math.pi))
        stage.put_car(standing(far * math.cos(angle), far * math.sin(angle), yaw))
    return stage


def turning(seed: int, frames: int) -> Scene:
    """The rig turns left at a junction among parked, crossing, oncoming and leading cars."""
    return staged(_turning, seed, frames)


def _turning(rng: np.random.Generator, duration_s: float) -> Stage:
    def fits(plan: JunctionPlan) -> bool:
        roads = (plan.along_x, plan.along_y)
        narrow = all(road.lanes_each_way == 1 and road.parking != "across" for road in roads)
        return narrow and plan.along_y.parking == "parallel"

    place_seed, plan = _junction(fits, rng)
    own, aside = -_lane(plan.along_x, 0), _lane(plan.along_y, 0)
    before_m, turn = 20.0, bend(9.0, math.pi / 2)
    start_x = aside - displacement((turn,))[0] - before_m
    after_m = before_m + turn.length_m
    speeds = ((before_m - 6.0, 6.5), (before_m, 5.5), (after_m, 5.5), (after_m + 6.0, 6.5))
    ego = course((start_x, own), 0.0, (Leg(before_m), turn), speeds, duration_s)
    stage = set_up("junction", place_seed, rng, ego, duration_s)
    others = (
        ((start_x + 16.0, own, 0.0), 6.5, 0.0),
        ((aside, own, math.pi / 2), float(rng.uniform(7.0, 7.6)), 0.2),
        ((aside, -own, math.pi), 8.0, 1.9),
        ((-aside, 30.0, -math.pi / 2), float(rng.uniform(6.5, 7.5)), 5.0),
        ((aside, -own, math.pi), 8.0, 7.6),
    )
    for at, speed, at_s in others:
        stage.put_car(_passing(at, speed, at_s, duration_s))
    stage.park(0.6, (-60.0, 60.0), 45.0)
    return stage


def people(seed: int, frames: int) -> Scene:
    """People walk over a crossing before the standing rig and along both pavements, past each other."""
    return staged(_people, seed, frames, at_once=True)


def _people(rng: np.random.Generator, duration_s: float) -> Stage:
    def fits(seed: int) -> bool:
        section = street_section(seed)
        return section.lanes_each_way == 1 and section.pavement_m > 2.8

    place_seed = seed_where(fits, rng)
    section = street_section(place_seed)
    crossings = build_place("street", place_seed).layout.crossings
    if not crossings:
        raise Misfit
    strip = crossings[0]
    ego_x = strip.start[0] - 9.5
    stage = set_up("street", place_seed, rng, standing(ego_x, -_lane(section, 0), 0.0), duration_s)
    met_s = float(rng.uniform(3.5, 4.5))
    ways = [(strip.at(0.5 * strip.length_m), math.pi / 2)]
    pavement_y = section.pavement_line_m + 0.5 * section.pavement_m
    ways += [((ego_x + float(rng.uniform(7.0, 16.0)), side * pavement_y), 0.0) for side in (-1.0, 1.0)]
    for (x, y), yaw in ways:
        for there in (yaw, yaw + math.pi):
            aside = (x + 0.7 * math.sin(there), y - 0.7 * math.cos(there))
            walk = _passing((*aside, there), float(rng.uniform(1.1, 1.5)), met_s, duration_s)
            stage.put(stage.look("pedestrian"), walk)
    return stage


def _junction(fits: Callable[[JunctionPlan], bool], rng: np.random.Generator) -> tuple[int, JunctionPlan]:
    """A junction without signals, which would have to change."""
    seed = seed_where(lambda seed: not junction_plan(seed).has_signals and fits(junction_plan(seed)), rng)
    return seed, junction_plan(seed)


def _lane(section: Section, from_middle: int) -> float:
    """How far the middle of a lane lies from that of the road."""
    return 0.5 * section.median_m + (from_middle + 0.5) * section.lane_width_m


def _half_turn(width_m: float) -> Leg:
    """A bend to the left that comes back so far beside where it began."""
    radius = 0.5 * width_m
    for _ in range(5):
        radius += 0.5 * (width_m - displacement((bend(radius, math.pi),))[1])
    return bend(radius, math.pi)


def _passing(at: tuple[float, float, float], speed: float, at_s: float, duration_s: float) -> Path:
    """Straight and steady movement that is at a place (x, y; m) and heads in its direction at `at_s`."""
    x, y, yaw = at
    start = (x - speed * at_s * math.cos(yaw), y - speed * at_s * math.sin(yaw))
    return course(start, yaw, (), speed, duration_s)
