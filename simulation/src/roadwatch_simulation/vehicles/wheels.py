"""Wheels: tyre, rim, spokes or hub cap, standing upright with their outer face to the left."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from roadwatch_simulation.assembly import Assembly
from roadwatch_simulation.geometry import Patch, lathe, rotation, shade
from roadwatch_simulation.materials import BRAKE, DARK_RIM, HUB_CAP, RIM, SEAM, TYRE
from roadwatch_simulation.model import Material

TYRE_SEGMENTS = 24


@dataclass(frozen=True)
class WheelDesign:
    """How the wheels of one vehicle look; `rim_share` is the rim's radius against the tyre's."""

    metal: Material
    spokes: int
    spoke_width: float
    twist_rad: float
    rim_share: float
    capped: bool


def draw_wheels(rng: np.random.Generator, plain: float = 0.2) -> WheelDesign:
    """A wheel design; `plain` is the share of vehicles on steel wheels with hub caps."""
    capped = bool(rng.random() < plain)
    metal = HUB_CAP if capped else (DARK_RIM if rng.random() < 0.25 else RIM)
    spokes = int(rng.choice([5, 5, 6, 7, 8, 10]))
    width = float(rng.uniform(0.34, 0.60)) / spokes
    twist, rim_share = float(rng.uniform(0, 0.25)), float(rng.uniform(0.64, 0.73))
    return WheelDesign(metal, spokes, width, twist, rim_share, capped)


def add_wheel(
    assembly: Assembly,
    design: WheelDesign,
    place: tuple[float, float, float],
    width_m: float,
    part: str | None,
) -> None:
    """Adds a wheel whose outer face's centre is at `place` (m); left of the car if y is above 0.

    The radius is the place's height, so that the tyre stands on the ground.
    """
    x, y, radius = place
    for patch, material in _wheel(design, radius, width_m):
        outward = patch.moved((x, abs(y), radius))
        assembly.add(outward if y > 0 else outward.mirrored(), material, part)


@lru_cache(maxsize=4)
def _wheel(design: WheelDesign, radius: float, width: float) -> tuple[tuple[Patch, Material], ...]:
    upright = rotation("x", -np.pi / 2)
    rim = radius * design.rim_share
    tyre = [
        (rim * 0.9, -width), (radius * 0.96, -width), (radius, -width + 0.03), (radius, -0.03),
        (radius * 0.955, -0.002), (radius * 0.86, 0.008), (rim, -0.010),
    ]  # fmt: skip
    dish = [(rim, -0.012), (rim * 0.955, -0.008), (rim * 0.90, -0.05)]
    well = [(rim * 0.90, -0.055), (0.0, -0.055)]
    turned = [
        (lathe(tyre, TYRE_SEGMENTS), TYRE),
        (lathe(dish, TYRE_SEGMENTS), design.metal),
        (lathe(well, 16), SEAM),
        (lathe([(rim * 0.62, -0.054), (rim * 0.58, -0.05), (0.0, -0.05)], 14), BRAKE),
        (_face(design, rim), design.metal),
        (lathe([(rim * 0.22, -0.045), (rim * 0.19, -0.014), (0.0, -0.012)], 10), design.metal),
    ]
    return tuple((patch.turned(upright), material) for patch, material in turned)


def _face(design: WheelDesign, rim: float) -> Patch:
    """The spokes, or the disc of a hub cap with its openings left dark, facing z."""
    if design.capped:
        return lathe([(rim * 0.95, -0.03), (rim * 0.80, -0.018), (rim * 0.3, -0.022)], 20)
    vertices: list[tuple[float, float, float]] = []
    faces: list[tuple[int, ...]] = []
    for number in range(design.spokes):
        angle = 2.0 * np.pi * number / design.spokes
        start = len(vertices)
        ends = ((0.12, 0.7, -0.02, 0.0), (0.93, 1.0, -0.028, design.twist_rad))
        for share, half_width, height, twist in ends:
            for side in (-1.0, 1.0):
                aside = side * np.pi * design.spoke_width * half_width * (0.55 if share > 0.5 else 1.6)
                direction = angle + twist + aside
                ring = rim * share
                for depth, wider in ((0.0, 1.0), (-0.03, 1.06)):
                    turn = angle + twist + aside * wider
                    at = direction if depth == 0.0 else turn
                    vertices.append((ring * np.cos(at), ring * np.sin(at), height + depth))
        inner_right, inner_left, outer_right, outer_left = start, start + 2, start + 4, start + 6
        faces.append((inner_right, outer_right, outer_left, inner_left))
        faces.append((inner_left, outer_left, outer_left + 1, inner_left + 1))
        faces.append((outer_right, inner_right, inner_right + 1, outer_right + 1))
    return shade(np.array(vertices), faces)
