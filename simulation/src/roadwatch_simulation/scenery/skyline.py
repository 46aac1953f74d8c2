"""The far ground and what closes the view: distant buildings, woods and hills."""

from __future__ import annotations

import math

import numpy as np

from ..model import Material, Surface
from .palette import WALL_SHADES, choice, varied
from .site import Site

GROUND_REACH_M = 420.0
"""Half the side of the ground: beyond it lies haze."""


def add_surroundings(site: Site, inner_m: float, *, ground: Material | None = None) -> None:
    """Adds the ground under everything and a ring of distant shapes, none nearer than `inner_m`."""
    builder, rng = site.builder, site.rng
    material = ground or site.ground.grass
    step = 140.0
    for x in np.arange(-GROUND_REACH_M, GROUND_REACH_M, step):
        for y in np.arange(-GROUND_REACH_M, GROUND_REACH_M, step):
            builder.rectangles([[x, y]], [[x + step, y + step]], -0.06, material)
    kind = choice(rng, ("town", "woods", "mixed", "hills"))
    for angle in np.arange(0.0, 2.0 * math.pi, 2.0 * math.pi / 56):
        distance = inner_m + rng.uniform(10.0, 130.0)
        if kind == "town" or (kind == "mixed" and rng.random() < 0.5):
            _add_block(site, angle, distance)
        else:
            _add_wood(site, angle, distance)
    if kind == "hills":
        _add_hills(site)


def _add_block(site: Site, angle: float, distance: float) -> None:
    rng, builder = site.rng, site.builder
    material = Material("far wall", varied(rng, choice(rng, WALL_SHADES)), surface=Surface.PLASTER)
    panes = Material("far panes", varied(rng, (0.10, 0.11, 0.12)), gloss=0.5, f0=0.04)
    width, depth, height = rng.uniform(12, 40), rng.uniform(10, 25), rng.uniform(6, 30)
    with builder.placed(distance * math.cos(angle), distance * math.sin(angle), angle):
        builder.box((0, -width / 2, 0), (depth, width / 2, height), material)
        for z in np.arange(1.6, height - 1.5, 3.3):
            builder.box((-0.1, -width / 2 + 1, z), (0, width / 2 - 1, z + 1.4), panes, ("-x",))


def _add_wood(site: Site, angle: float, distance: float) -> None:
    """A band of tree tops with a ragged edge, facing the origin."""
    rng, builder = site.rng, site.builder
    width, count = rng.uniform(25, 60), 14
    material = Material("far wood", varied(rng, (0.05, 0.075, 0.03), 0.3), surface=Surface.GRASS)
    y = np.linspace(width / 2, -width / 2, count)
    outline = np.sin(np.linspace(0.35, math.pi - 0.35, count))
    top = rng.uniform(5, 14) * (0.75 + 0.25 * rng.random(count)) * outline
    low = np.stack([np.zeros(count), y, np.full(count, -0.5)], 1)
    high = np.stack([rng.uniform(0, 3, count), y, top], 1)
    with builder.placed(distance * math.cos(angle), distance * math.sin(angle), angle):
        builder.quads(np.stack([low[:-1], low[1:], high[1:], high[:-1]], 1), material)


def _add_hills(site: Site) -> None:
    rng = site.rng
    angle = np.linspace(0.0, 2.0 * math.pi, 49)
    height = 9.0 + 9.0 * np.sin(3 * angle + rng.uniform(0, 6)) + 6.0 * np.sin(7 * angle + rng.uniform(0, 6))
    height[-1] = height[0]
    reach = GROUND_REACH_M - 10.0
    rim = np.stack([reach * np.cos(angle), reach * np.sin(angle)], 1)
    low = np.concatenate([rim, np.full((49, 1), -1.0)], 1)
    high = np.concatenate([rim * 1.25, np.maximum(height, 1.0)[:, None]], 1)
    material = Material("hills", varied(rng, (0.07, 0.09, 0.05)), surface=Surface.GRASS)
    site.builder.quads(np.stack([low[1:], low[:-1], high[:-1], high[1:]], 1), material)
