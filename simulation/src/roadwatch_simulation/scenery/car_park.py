"""A car park: double rows of bays along x with aisles between, islands, lamps, and a building behind."""

from __future__ import annotations

import math

import numpy as np

from . import furniture
from .buildings import add_building
from .clutter import CLUTTER
from .layout import Place
from .palette import WHITE_PAINT, YELLOW_PAINT, choice
from .section import MARKING_Z_M
from .site import Site
from .skyline import add_surroundings
from .trees import add_hedge

BAY_M = (5.0, 2.5)
AISLE_M = 6.4
KERB_M = 0.12


def build_car_park(seed: int) -> Place:
    """A car park with the origin in the middle of an aisle, as the seed has it."""
    site = Site("car park", seed)
    rng = site.rng
    columns = int(rng.integers(16, 30))
    aisles = int(rng.integers(2, 5))
    pitch = AISLE_M + 2 * BAY_M[0]
    half_length = 0.5 * columns * BAY_M[1]
    middle_aisle = int(rng.integers(aisles))
    paint = choice(rng, (WHITE_PAINT, WHITE_PAINT, YELLOW_PAINT))
    y_of = [(index - middle_aisle) * pitch for index in range(aisles)]
    low, high = y_of[0] - 0.5 * pitch, y_of[-1] + 0.5 * pitch
    reach = half_length + AISLE_M + 1.0
    add_surroundings(site, max(120.0, 1.6 * reach))
    site.road((-reach, reach), (low - 0.5, high + 0.5))
    for y in y_of:
        _add_aisle(site, y, half_length, columns, reach, paint)
    for y in (*(y - 0.5 * pitch for y in y_of), y_of[-1] + 0.5 * pitch):
        _add_row_ends(site, y, half_length)
    _add_cross_aisles(site, low, high, reach)
    _add_edges(site, reach, low, high)
    return site.place()


def _add_aisle(site: Site, y: float, half_length: float, columns: int, reach: float, paint) -> None:
    """One aisle with a row of bays on each side."""
    site.lane((-reach, y - AISLE_M / 4), (reach, y - AISLE_M / 4), AISLE_M / 2)
    site.lane((reach, y + AISLE_M / 4), (-reach, y + AISLE_M / 4), AISLE_M / 2)
    edges = -half_length + np.arange(columns + 1) * BAY_M[1]
    for side in (-1, 1):
        near, far = y + side * AISLE_M / 2, y + side * (AISLE_M / 2 + BAY_M[0])
        low, high = min(near, far), max(near, far)
        lower = np.stack([edges - 0.05, np.full(columns + 1, low)], 1)
        upper = np.stack([edges + 0.05, np.full(columns + 1, high)], 1)
        site.builder.rectangles(lower, upper, MARKING_Z_M, paint)
        for x in edges[:-1] + 0.5 * BAY_M[1]:
            site.bay(float(x), 0.5 * (near + far), side * math.pi / 2, *BAY_M)
    site.walk((-half_length, y), (half_length, y), AISLE_M - 1.0)
    if site.rng.random() < 0.6:
        for x in np.arange(-half_length + 8.0, half_length, 22.0):
            _add_arrow(site, float(x), y - AISLE_M / 4)


def _add_arrow(site: Site, x: float, y: float) -> None:
    site.builder.rectangles([[x, y - 0.08]], [[x + 2.2, y + 0.08]], MARKING_Z_M, WHITE_PAINT)
    head = [[x + 3.2, y, MARKING_Z_M], [x + 2.2, y + 0.35, MARKING_Z_M], [x + 2.2, y - 0.35, MARKING_Z_M]]
    site.builder.triangles(np.array([head]), WHITE_PAINT)


def _add_row_ends(site: Site, y: float, half_length: float) -> None:
    """Planted islands at both ends of a double row, with a lamp or a tree."""
    for sign in (-1, 1):
        x = sign * (half_length + 0.9)
        site.slab((x - 0.8, x + 0.8), (y - 4.2, y + 4.2), KERB_M, site.ground.grass)
        for offset in (-2.6, 2.6):
            if site.rng.random() < 0.7:
                site.tree(x, y + offset, KERB_M)
        if site.rng.random() < 0.7:
            site.put(furniture.add_street_lamp, x, y, z_m=KERB_M)


def _add_cross_aisles(site: Site, low: float, high: float, reach: float) -> None:
    x = reach - 0.4 * AISLE_M
    site.lane((x, low), (x, high), AISLE_M / 2)
    site.lane((-x, high), (-x, low), AISLE_M / 2)


def _add_edges(site: Site, reach: float, low: float, high: float) -> None:
    """A shop behind one long side; hedges, fences and trees on the others."""
    rng, builder = site.rng, site.builder
    shop_side = int(rng.integers(4))
    sides = ((high, reach, 0.0), (reach, high, -math.pi / 2), (-low, reach, math.pi),
        (reach, -low, math.pi / 2))
    for index, (distance, half, yaw) in enumerate(sides):
        half = reach if index % 2 == 0 else max(abs(low), high)
        with builder.placed(0.0, 0.0, yaw):
            site.slab((-half, half), (distance + 0.6, distance + 4.0), KERB_M, site.ground.grass)
            if index == shop_side:
                _add_shop(site, half, distance)
                continue
            _add_boundary(site, half, distance)


def _add_shop(site: Site, half: float, distance: float) -> None:
    rng, builder = site.rng, site.builder
    x = -half
    while x < half - 10.0:
        width = float(min(rng.uniform(14.0, 45.0), half - x))
        with builder.placed(x, distance + 4.5):
            add_building(builder, width, 15.0, rng, choice(rng, ("hall", "town", "hall", "tower")))
        x += width + rng.uniform(0.0, 2.0)


def _add_boundary(site: Site, half: float, distance: float) -> None:
    rng, builder = site.rng, site.builder
    for x in np.arange(-half, half - 10.0, 12.0):
        with builder.placed(float(x), distance + 1.6, 0.0, KERB_M):
            if rng.random() < 0.5:
                add_hedge(builder, 11.5, 0.8, rng.uniform(0.8, 1.8), rng)
            else:
                furniture.add_fence(builder, 12.0, rng)
        if rng.random() < 0.6:
            site.tree(float(x) + rng.uniform(1, 10), distance + 3.0, KERB_M)
        if rng.random() < 0.4:
            add, size = choice(rng, CLUTTER)
            site.put(add, float(x) + rng.uniform(3, 8), distance - 1.0, size_m=size)
    for x in np.arange(-half, half - 14.0, rng.uniform(18.0, 34.0)):
        if rng.random() < 0.7:
            with builder.placed(float(x), distance + rng.uniform(10.0, 25.0)):
                style = choice(rng, ("house", "town", "hall"))
                add_building(builder, rng.uniform(10.0, 17.0), 11.0, rng, style)
