"""A crossroads at the origin: two roads, along x and along y, with four arms."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from . import furniture
from .frontage import line_road_side
from .layout import Place
from .section import Section, add_centre_line, add_road_side, add_zebra, draw_section
from .site import Site
from .skyline import add_surroundings

REACH_M = 95.0
CORNER_M = 5.0
"""Radius of the kerb at the corners."""
CROSSING_M = 4.2
"""Length of an arm that the zebra crossing takes, before the stop line."""


@dataclass(frozen=True)
class JunctionPlan:
    """The two roads of a junction, along x and along y, and its signals."""

    along_x: Section
    along_y: Section
    has_signals: bool
    green_along_x: bool


def build_junction(seed: int) -> Place:
    """A junction, as the seed has it."""
    site = Site("junction", seed)
    plan = _draw_plan(site)
    along_x, along_y = plan.along_x, plan.along_y
    add_surroundings(site, 150.0)
    _add_middle(site, along_x, along_y)
    for arm in range(4):
        here, other = (along_x, along_y) if arm % 2 == 0 else (along_y, along_x)
        with site.builder.placed(0.0, 0.0, arm * math.pi / 2):
            _add_arm(site, here, other, owns_corner=arm % 2 == 0)
            if plan.has_signals:
                _add_signals(site, here, other, 2 if (arm % 2 == 0) == plan.green_along_x else 0)
    return site.place()


def junction_plan(seed: int) -> JunctionPlan:
    """What the junction with that seed is like, without building it."""
    return _draw_plan(Site("junction", seed))


def _draw_plan(site: Site) -> JunctionPlan:
    rng = site.rng
    along_x = draw_section(rng)
    along_y = replace(draw_section(rng), kerb_m=along_x.kerb_m, style=along_x.style)
    return JunctionPlan(along_x, along_y, bool(rng.random() < 0.75), bool(rng.random() < 0.5))


def _arm_start(other: Section) -> float:
    return other.kerb_line_m + CORNER_M


def _add_arm(site: Site, here: Section, other: Section, *, owns_corner: bool) -> None:
    start = _arm_start(other)
    add_zebra(site, here, start + 0.5 * CROSSING_M - 0.3)
    span = (start, REACH_M)
    inner = (start + CROSSING_M, REACH_M)
    half = here.kerb_line_m
    site.builder.rectangles([[REACH_M, -half]], [[REACH_M + 220.0, half]], -0.01, site.ground.road)
    add_centre_line(site, here, inner)
    _fill_crossing(site, here, span)
    buildings_from = other.building_line_m + (0.5 if owns_corner else 16.0)
    for turned in (False, True):
        with site.builder.placed(start + REACH_M if turned else 0.0, 0.0, math.pi if turned else 0.0):
            sides = (start, REACH_M - CROSSING_M) if turned else inner
            add_road_side(site, here, sides, stop_line=not turned)
            plots = (start, start + REACH_M - buildings_from) if turned else (buildings_from, REACH_M)
            line_road_side(site, here, sides, *plots)


def _fill_crossing(site: Site, here: Section, span) -> None:
    """The arm's ground under its zebra crossing, with lowered kerbs."""
    end = span[0] + CROSSING_M
    half, edge = here.kerb_line_m, here.frontage_line_m
    site.road((span[0], end), (-half, half))
    for side in ((half, edge), (-edge, -half)):
        site.slab((span[0], end), side, here.kerb_m, site.ground.paving)


def _add_middle(site: Site, along_x: Section, along_y: Section) -> None:
    """The crossing's own asphalt and the four rounded corners."""
    half_x, half_y = _arm_start(along_y), _arm_start(along_x)
    site.road((-half_x, half_x), (-half_y, half_y))
    for sign_x, sign_y in ((1, 1), (-1, 1), (-1, -1), (1, -1)):
        _add_corner(site, along_x, along_y, sign_x, sign_y)


def _add_corner(site: Site, along_x: Section, along_y: Section, sign_x: int, sign_y: int) -> None:
    inner = np.array([along_y.kerb_line_m, along_x.kerb_line_m])
    outer = np.maximum(inner + CORNER_M, [along_y.building_line_m, along_x.building_line_m])
    angle = np.linspace(1.5 * math.pi, math.pi, 9)
    arc = inner + CORNER_M + CORNER_M * np.stack([np.cos(angle), np.sin(angle)], 1)
    rim = np.concatenate([[[outer[0], inner[1]]], arc, [[inner[0], outer[1]]], [outer]])
    rim = rim[::-1]
    signs = np.array([sign_x, sign_y])
    middle, rim = outer * signs, rim * signs
    if sign_x * sign_y < 0:
        rim = rim[::-1]
    height = along_x.kerb_m
    top = np.concatenate([rim, np.full((len(rim), 1), height)], 1)
    site.builder.fan((*middle, height), top, site.ground.paving)
    low = np.concatenate([rim, np.full((len(rim), 1), -0.02)], 1)
    site.builder.quads(np.stack([low[:-1], low[1:], top[1:], top[:-1]], 1), site.ground.kerb)
    corners = np.sort(np.stack([inner * signs, outer * signs]), axis=0)
    site.raised((corners[0, 0], corners[1, 0]), (corners[0, 1], corners[1, 1]), height)


def _add_signals(site: Site, here: Section, other: Section, state: int) -> None:
    """Lights for the traffic that comes towards the junction on this arm, near and far."""
    reach = 0.6 * here.travelled_m if here.lanes_each_way > 1 else 0.0
    near = _arm_start(other) + CROSSING_M + 0.6

    def near_light(builder, rng):
        furniture.add_traffic_light(builder, rng, state)

    def far_light(builder, rng):
        furniture.add_traffic_light(builder, rng, state, arm_m=reach)

    y = here.kerb_line_m + 0.5
    site.put(near_light, near, y, yaw_rad=math.pi, z_m=here.kerb_m)
    site.put(far_light, -near, y, yaw_rad=math.pi, z_m=here.kerb_m)
