"""Larger things that stand about and are no vehicles, which a detector has to learn: skips, kiosks,
crates.
"""

from __future__ import annotations

import numpy as np

from ..model import Material, Surface
from .builder import ALL_FACES, MeshBuilder
from .palette import (
    ACCENT_SHADES, CONCRETE, DARK_STEEL, GLASS, RETROREFLECTIVE, RUBBER, STEEL, WOOD, choice, painted, varied,
)

_ORANGE = Material("warning orange", (0.72, 0.16, 0.02), gloss=0.2, f0=0.03)


def add_skip(builder: MeshBuilder, rng: np.random.Generator) -> None:
    """An open container for rubble along x, its ends sloping."""
    material = painted(rng, ACCENT_SHADES, 0.2)
    half, top, foot = 0.8, rng.uniform(1.7, 2.1), rng.uniform(1.0, 1.3)
    height = rng.uniform(1.1, 1.5)
    low = [(-foot, -half, 0.1), (foot, -half, 0.1), (foot, half, 0.1), (-foot, half, 0.1)]
    high = [(-top, -half, height), (top, -half, height), (top, half, height), (-top, half, height)]
    sides = [[low[i], low[(i + 1) % 4], high[(i + 1) % 4], high[i]] for i in range(4)]
    builder.quads(np.array(sides + [side[::-1] for side in sides]), material)
    builder.box((-top * 0.9, -half + 0.05, 0.3), (top * 0.9, half - 0.05, height - 0.3), CONCRETE)


def add_dumpster(builder: MeshBuilder, rng: np.random.Generator) -> None:
    """A wheeled waste container with a lid."""
    material = painted(rng, ((0.03, 0.16, 0.07), (0.05, 0.10, 0.25), (0.25, 0.26, 0.27), (0.35, 0.25, 0.05)))
    width, height = rng.uniform(0.6, 0.95), rng.uniform(1.0, 1.35)
    builder.box((-width, -0.5, 0.18), (width, 0.5, height), material, ALL_FACES)
    builder.box((-width - 0.05, -0.55, height), (width + 0.05, 0.55, height + 0.12), RUBBER, ALL_FACES)
    for x in (-width + 0.1, width - 0.1):
        for y in (-0.42, 0.42):
            builder.box((x - 0.06, y - 0.04, 0), (x + 0.06, y + 0.04, 0.2), RUBBER)


def add_kiosk(builder: MeshBuilder, rng: np.random.Generator) -> None:
    """A small booth with a window towards -y."""
    walls, trim = painted(rng), painted(rng)
    width, height = rng.uniform(1.0, 1.9), rng.uniform(2.2, 2.7)
    builder.box((-width, -0.9, 0), (width, 0.9, height), walls)
    builder.box((-width + 0.2, -0.93, 1.0), (width - 0.2, -0.9, height - 0.4), GLASS, ("-y",))
    builder.box((-width - 0.3, -1.2, height), (width + 0.3, 1.1, height + 0.2), trim, ALL_FACES)


def add_billboard(builder: MeshBuilder, rng: np.random.Generator) -> None:
    """A board on two posts that shows blocks of colour, facing -y."""
    width, low, high = rng.uniform(1.2, 2.4), rng.uniform(0.6, 1.8), rng.uniform(2.8, 4.2)
    for x in (-0.7 * width, 0.7 * width):
        builder.box((x - 0.06, -0.05, 0), (x + 0.06, 0.05, low), DARK_STEEL)
    builder.box((-width, -0.08, low), (width, 0.08, high), STEEL, ALL_FACES)
    for _ in range(int(rng.integers(3, 8))):
        x, z = rng.uniform(-width, 0.6 * width), rng.uniform(low + 0.05, high - 0.5)
        end = (min(width - 0.05, x + rng.uniform(0.3, width)), -0.085,
            min(high - 0.05, z + rng.uniform(0.2, 1.2)))
        builder.box((x, -0.09 - 0.002 * rng.random(), z), end, painted(rng), ("-y",))


def add_barrier(builder: MeshBuilder, rng: np.random.Generator) -> None:
    """A striped road barrier along x, or a row of cones."""
    if rng.random() < 0.5:
        for x in np.arange(-1.2, 1.3, 0.8):
            builder.cylinder((x, 0, 0.03), 0.68, 0.15, _ORANGE, sides=8, top_radius_m=0.03)
            builder.cylinder((x, 0, 0.3), 0.14, 0.112, RETROREFLECTIVE, sides=8, top_radius_m=0.09)
            builder.box((x - 0.18, -0.18, 0), (x + 0.18, 0.18, 0.04), RUBBER)
        return
    for index, x in enumerate(np.arange(-1.2, 1.2, 0.3)):
        material = _ORANGE if index % 2 else RETROREFLECTIVE
        builder.box((x, -0.03, 0.75), (x + 0.3, 0.03, 1.0), material, ALL_FACES)
    for x in (-1.0, 1.0):
        builder.box((x - 0.04, -0.25, 0), (x + 0.04, 0.25, 0.75), DARK_STEEL)


def add_crates(builder: MeshBuilder, rng: np.random.Generator) -> None:
    """A stack of boxes and sacks."""
    for _ in range(int(rng.integers(2, 7))):
        x, y = rng.uniform(-0.7, 0.7), rng.uniform(-0.4, 0.4)
        size = rng.uniform(0.2, 0.45, 3)
        shade = choice(rng, ((0.32, 0.22, 0.12), (0.05, 0.05, 0.055), (0.25, 0.26, 0.27), (0.1, 0.2, 0.4)))
        material = Material("crate", varied(rng, shade), surface=Surface.CLOTH)
        builder.box((x - size[0], y - size[1], 0), (x + size[0], y + size[1], 2 * size[2]), material)


def add_tables(builder: MeshBuilder, rng: np.random.Generator) -> None:
    """A table with chairs, under a parasol at times."""
    builder.cylinder((0, 0, 0), 0.72, 0.05, DARK_STEEL, sides=6)
    builder.cylinder((0, 0, 0.72), 0.04, 0.45, WOOD, sides=12)
    for x in (-0.75, 0.75):
        builder.box((x - 0.2, -0.2, 0.0), (x + 0.2, 0.2, 0.45), DARK_STEEL)
        builder.box((x * 1.25 - 0.03, -0.2, 0.45), (x * 1.25 + 0.03, 0.2, 0.9), WOOD, ALL_FACES)
    if rng.random() < 0.6:
        cloth = Material("parasol", varied(rng, choice(rng, ACCENT_SHADES)), surface=Surface.CLOTH)
        builder.cylinder((0, 0, 0.7), 1.8, 0.025, STEEL, sides=6)
        builder.cylinder((0, 0, 2.1), 0.45, 1.35, cloth, sides=8, top_radius_m=0.03)


CLUTTER = (
    (add_skip, (4.2, 1.7)), (add_dumpster, (2.0, 1.2)), (add_kiosk, (4.4, 2.4)), (add_billboard, (4.8, 0.4)),
    (add_barrier, (2.6, 0.6)), (add_crates, (2.2, 1.7)), (add_tables, (2.8, 2.8)), (add_dumpster, (2.0, 1.2)),
    (add_crates, (2.2, 1.7)), (add_tables, (2.8, 2.8)),
)  # fmt: skip
"""What may stand about, with the size of its footprint (m)."""
