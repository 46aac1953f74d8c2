"""What stands along streets: lamps, lights, signs, fences, bins, bollards, shelters."""

from __future__ import annotations

import numpy as np

from ..model import Material
from .builder import ALL_FACES, MeshBuilder
from .palette import (
    ACCENT_SHADES, DARK_STEEL, GLASS, RETROREFLECTIVE, RUBBER, STEEL, WOOD, choice, painted, wall,
)

SIGN_FACES = ((0.55, 0.02, 0.02), (0.02, 0.10, 0.45), (0.74, 0.74, 0.73), (0.65, 0.50, 0.02),
    (0.02, 0.25, 0.08))
_LAMP = Material("lamp", (0.8, 0.75, 0.6), gloss=0.6, f0=0.05, emission=0.6)


def add_street_lamp(builder: MeshBuilder, rng: np.random.Generator, reach_m: float = 1.6) -> None:
    """A lamp whose arm reaches over +y from its post at the frame's origin."""
    height = rng.uniform(5.0, 9.0)
    metal = choice(rng, (STEEL, DARK_STEEL))
    builder.cylinder((0, 0, 0), height, 0.09, metal, sides=8, top_radius_m=0.05)
    builder.cylinder((0, 0, 0), 1.1, 0.13, metal, sides=8)
    if rng.random() < 0.75:
        builder.box((-0.035, 0, height - 0.1), (0.035, reach_m, height - 0.02), metal, ALL_FACES)
        builder.box((-0.14, reach_m - 0.2, height - 0.16), (0.14, reach_m + 0.5, height - 0.04), metal,
            ALL_FACES)
        builder.box((-0.1, reach_m - 0.1, height - 0.18), (0.1, reach_m + 0.4, height - 0.16), _LAMP,
            ALL_FACES)
    else:
        builder.cylinder((0, 0, height), 0.45, 0.14, _LAMP, sides=8, top_radius_m=0.22)


def add_traffic_light(builder: MeshBuilder, rng: np.random.Generator, state: int, arm_m: float = 0.0) -> None:
    """Lights facing -x, on a post or over the road on an arm along +y; `state` 0 red, 1 amber, 2 green."""
    metal = choice(rng, (STEEL, DARK_STEEL, DARK_STEEL))
    post = 5.6 if arm_m > 0 else 3.4
    builder.cylinder((0, 0, 0), post, 0.09 if arm_m > 0 else 0.06, metal, sides=8)
    _signal_head(builder, (0.0, 0.0, 2.3), state)
    if arm_m > 0:
        builder.box((-0.06, 0, post - 0.2), (0.06, arm_m, post - 0.08), metal, ALL_FACES)
        _signal_head(builder, (0.0, arm_m - 0.3, post - 1.05), state)


def _signal_head(builder: MeshBuilder, at, state: int) -> None:
    x, y, z = at
    builder.box((x - 0.22, y - 0.17, z), (x - 0.04, y + 0.17, z + 0.98), RUBBER, ALL_FACES)
    for index, colour in enumerate(((0.9, 0.03, 0.02), (0.9, 0.45, 0.02), (0.03, 0.75, 0.30))):
        lit = index == state
        lens = Material("signal", tuple(c if lit else c * 0.12 for c in colour), 0.4, 0.04,
            emission=2.5 * lit)
        middle = z + 0.82 - 0.32 * index
        angle = np.linspace(2 * np.pi, 0.0, 11)
        rim = np.stack([np.full(11, x - 0.225), y + 0.11 * np.cos(angle), middle + 0.11 * np.sin(angle)], 1)
        builder.fan((x - 0.225, y, middle), rim, lens)
        builder.box((x - 0.36, y - 0.12, middle + 0.11), (x - 0.22, y + 0.12, middle + 0.135), RUBBER,
            ALL_FACES)


def add_sign(builder: MeshBuilder, rng: np.random.Generator) -> None:
    """A sign on a post, facing -x."""
    height = rng.uniform(2.1, 2.9)
    builder.cylinder((0, 0, 0), height + 0.35, 0.035, STEEL, sides=6)
    sides = int(choice(rng, (3, 4, 4, 8, 16, 16)))
    radius, turn = rng.uniform(0.28, 0.42), (np.pi / 4 if sides == 4 else np.pi / 2 if sides == 3 else 0.0)
    colour = painted(rng, SIGN_FACES, 0.25)
    for size, offset, material in ((1.0, -0.045, colour), (0.74, -0.05, RETROREFLECTIVE)):
        if size < 1.0 and rng.random() < 0.35:
            continue
        _plate(builder, (offset, 0.0, height), radius * size, sides, turn, material)
    _plate(builder, (-0.04, 0.0, height), radius, sides, turn, STEEL, back=True)


def _plate(builder, centre, radius, sides, turn, material, back=False) -> None:
    angle = turn + np.linspace(0.0, 2.0 * np.pi, sides + 1) * (1 if back else -1)
    rim = np.stack([np.full(sides + 1, centre[0]), centre[1] + radius * np.cos(angle),
                    centre[2] + radius * np.sin(angle)], 1)
    builder.fan(centre, rim, material)


def add_bollard(builder: MeshBuilder, rng: np.random.Generator) -> None:
    """A short post."""
    material = painted(rng, ((0.05, 0.05, 0.05), (0.4, 0.4, 0.4), (0.6, 0.5, 0.05)))
    builder.cylinder((0, 0, 0), 0.85, 0.07, material, sides=8)
    builder.cylinder((0, 0, 0.68), 0.08, 0.074, RETROREFLECTIVE, sides=8)


def add_bin(builder: MeshBuilder, rng: np.random.Generator) -> None:
    """A litter bin, or a wheeled one."""
    material = painted(rng, ((0.03, 0.05, 0.03), (0.05, 0.05, 0.055), (0.03, 0.08, 0.22), (0.20, 0.21, 0.22)))
    if rng.random() < 0.5:
        builder.cylinder((0, 0, 0), 0.95, 0.24, material, sides=10, top_radius_m=0.27)
        return
    builder.box((-0.28, -0.35, 0.05), (0.28, 0.35, 0.98), material)
    builder.box((-0.31, -0.38, 0.98), (0.31, 0.38, 1.05), material, ALL_FACES)


def add_bench(builder: MeshBuilder, rng: np.random.Generator) -> None:
    """A bench along x, its front towards -y."""
    del rng
    builder.box((-0.8, -0.25, 0.40), (0.8, 0.2, 0.46), WOOD, ALL_FACES)
    builder.box((-0.8, 0.2, 0.55), (0.8, 0.25, 0.92), WOOD, ALL_FACES)
    for x in (-0.7, 0.7):
        builder.box((x - 0.04, -0.2, 0), (x + 0.04, 0.25, 0.9), DARK_STEEL)


def add_shelter(builder: MeshBuilder, rng: np.random.Generator) -> None:
    """A bus stop's shelter along x, open towards -y."""
    metal = painted(rng, ((0.1, 0.1, 0.11), (0.35, 0.36, 0.37)))
    for x in (-1.9, 0.0, 1.9):
        builder.box((x - 0.04, 0.6, 0), (x + 0.04, 0.68, 2.35), metal)
    for x in (-1.9, 1.9):
        builder.box((x - 0.03, -0.3, 0.3), (x + 0.03, 0.6, 2.2), GLASS)
    builder.box((-1.9, 0.62, 0.35), (1.9, 0.66, 2.2), GLASS)
    builder.box((-2.1, -0.75, 2.35), (2.1, 0.8, 2.48), metal, ALL_FACES)
    builder.box((1.72, -0.3, 0.5), (1.84, 0.55, 2.1), painted(rng, ACCENT_SHADES), ALL_FACES)
    builder.box((-1.5, 0.25, 0.45), (1.2, 0.55, 0.52), WOOD, ALL_FACES)


def add_fence(builder: MeshBuilder, length_m: float, rng: np.random.Generator) -> None:
    """A fence or low wall along x from the frame's origin."""
    style = int(rng.integers(3))
    if style == 0:
        material = painted(rng, ((0.2, 0.13, 0.07), (0.6, 0.6, 0.57), (0.1, 0.08, 0.06)), 0.05)
        builder.box((0, -0.03, 0.05), (length_m, 0.03, rng.uniform(0.9, 1.8)), material)
    elif style == 1:
        count = max(2, int(length_m / 0.16))
        x = np.linspace(0.0, length_m, count)
        low = np.stack([x - 0.012, np.full(count, -0.012), np.zeros(count)], 1)
        builder.boxes(low, low + [0.024, 0.024, 1.1], DARK_STEEL, ("-y", "+y"))
        for z in (0.15, 1.0):
            builder.box((0, -0.02, z), (length_m, 0.02, z + 0.04), DARK_STEEL, ALL_FACES)
    else:
        builder.box((0, -0.12, 0), (length_m, 0.12, rng.uniform(0.5, 1.3)), wall(rng))


def add_utility_pole(builder: MeshBuilder, rng: np.random.Generator) -> None:
    """A wooden pole with cross-arms along y."""
    height = rng.uniform(7.5, 10.0)
    builder.cylinder((0, 0, 0), height, 0.16, WOOD, sides=8, top_radius_m=0.11)
    for z in (height - 0.4, height - 1.2):
        builder.box((-0.05, -1.0, z), (0.05, 1.0, z + 0.12), WOOD, ALL_FACES)
        for y in (-0.9, -0.4, 0.4, 0.9):
            builder.cylinder((0, y, z + 0.12), 0.18, 0.04, RUBBER, sides=5)


def add_cabinet(builder: MeshBuilder, rng: np.random.Generator) -> None:
    """A utility cabinet."""
    width, height = rng.uniform(0.4, 0.9), rng.uniform(0.9, 1.4)
    material = painted(rng, ((0.12, 0.15, 0.12), (0.4, 0.4, 0.38), (0.25, 0.26, 0.25)), 0.15)
    builder.box((-width, -0.2, 0), (width, 0.2, height), material)
