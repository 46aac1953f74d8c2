"""What lines a road: furniture on the pavement, gardens, buildings."""

from __future__ import annotations

import math

import numpy as np

from . import furniture
from .buildings import add_building
from .clutter import CLUTTER
from .palette import choice
from .section import Section
from .site import Site
from .trees import add_hedge

NEAR_STREET_M = 14.0
"""Gardens and yards of fields and parks reach this far from the pavement before the open ground."""


def line_road_side(
    site: Site, section: Section, span: tuple[float, float], buildings_from_m: float, buildings_to_m: float
) -> None:
    """Lines one side of a road, in that side's frame: furniture over `span`, buildings over their range."""
    _furnish(site, section, span)
    _add_clutter(site, section, span)
    _add_plots(site, section, (buildings_from_m, buildings_to_m))


def _furnish(site: Site, section: Section, span: tuple[float, float]) -> None:
    """A row of things near the kerb, each a few metres from the next."""
    rng, kerb = site.rng, section.kerb_m
    y = section.kerb_line_m + (0.5 * section.verge_m if section.verge_m > 0 else 0.45)
    lamp_gap, tree_gap = rng.uniform(22, 40), rng.uniform(7, 16)
    tree_share = choice(rng, (0.0, 0.5, 0.9, 0.95))
    wires = rng.random() < 0.2
    next_lamp = span[0] + rng.uniform(2, lamp_gap)
    for x in np.arange(span[0] + 3.0, span[1] - 2.0, tree_gap):
        x = float(x)
        if x >= next_lamp:
            next_lamp += lamp_gap
            lamp = furniture.add_utility_pole if wires else furniture.add_street_lamp
            site.put(lamp, x, y, yaw_rad=math.pi, z_m=kerb)
        elif rng.random() < tree_share:
            site.tree(x, y, kerb)
        _add_small_things(site, section, x + 0.4 * tree_gap, y)
    if rng.random() < 0.3:
        x = float(rng.uniform(*span))
        site.put(furniture.add_shelter, x, section.frontage_line_m - 1.0, z_m=kerb, size_m=(4.2, 1.6))


def _add_small_things(site: Site, section: Section, x: float, y: float) -> None:
    rng, kerb = site.rng, section.kerb_m
    draw = rng.random()
    if draw < 0.14:
        site.put(furniture.add_sign, x, y, yaw_rad=math.pi + rng.normal(0.0, 0.15), z_m=kerb)
    elif draw < 0.22:
        site.put(furniture.add_bin, x, y, z_m=kerb, yaw_rad=rng.uniform(0, 6), size_m=(0.7, 0.7))
    elif draw < 0.28:
        site.put(furniture.add_bench, x, section.frontage_line_m - 0.4, z_m=kerb, size_m=(1.7, 0.6))
    elif draw < 0.34:
        site.put(furniture.add_cabinet, x, section.frontage_line_m - 0.3, z_m=kerb, size_m=(1.8, 0.5))
    elif draw < 0.44:
        for step in range(int(rng.integers(2, 5))):
            site.put(furniture.add_bollard, x + 1.4 * step, y, z_m=kerb, size_m=(0.2, 0.2))


def _add_clutter(site: Site, section: Section, span: tuple[float, float]) -> None:
    """Things that stand by the buildings, where the pavement is wide enough to leave a way."""
    rng = site.rng
    for x in np.arange(span[0] + 6.0, span[1] - 6.0, 11.0):
        add, size = choice(rng, CLUTTER)
        beyond = section.frontage_line_m + 0.5 * size[1] + 0.1
        room = beyond + 0.5 * size[1] < section.building_line_m
        wide = section.pavement_m > size[1] + 1.6
        if rng.random() < 0.3 and (room or wide):
            y = beyond if room else section.frontage_line_m - 0.5 * size[1] - 0.1
            site.put(add, float(x + rng.uniform(-3, 3)), y, z_m=section.kerb_m, size_m=size)


def _add_plots(site: Site, section: Section, span: tuple[float, float]) -> None:
    rng = site.rng
    depth_end = section.building_line_m + 14.0
    behind = site.ground.grass if section.style in ("house", "park", "mixed") else site.ground.paving
    site.builder.ground(span, (section.frontage_line_m, depth_end), section.kerb_m * 0.9, behind)
    x = span[0]
    while x < span[1] - 5.0:
        style = section.style
        if style == "mixed":
            style = choice(rng, ("town", "house", "park", "tower", "hall"))
        width = min(_plot_width(rng, style), span[1] - x)
        if width < 5.0:
            break
        _add_plot(site, section, x, width, style)
        x += width + (rng.uniform(0.0, 0.3) if style == "town" else rng.uniform(1.0, 7.0))


def _plot_width(rng: np.random.Generator, style: str) -> float:
    low, high = {"town": (7, 24), "house": (8, 15), "tower": (15, 32), "hall": (20, 45),
        "park": (12, 30)}[style]
    return float(rng.uniform(low, high))


def _add_plot(site: Site, section: Section, x: float, width: float, style: str) -> None:
    rng = site.rng
    if style == "park":
        _add_green(site, section, x, width, NEAR_STREET_M)
        return
    if section.setback_m > 2.5:
        _add_green(site, section, x, width, section.setback_m - 1.0)
    set_in = 0.0 if style == "town" else rng.uniform(0.0, 2.5)
    y = section.building_line_m + set_in
    far = site.is_far(x + 0.5 * width, y)
    with site.builder.placed(x, y, 0.0, section.kerb_m * 0.5):
        add_building(site.builder, width, rng.uniform(8.0, 14.0), rng, style, far=far)


def _add_green(site: Site, section: Section, x: float, width: float, depth: float) -> None:
    """A garden: something along the pavement, and plants behind it."""
    rng, edge = site.rng, section.frontage_line_m + 0.3
    draw = rng.random()
    with site.builder.placed(x + 0.4, edge, 0.0, section.kerb_m * 0.9):
        if draw < 0.35:
            add_hedge(site.builder, width - 1.2, rng.uniform(0.5, 0.9), rng.uniform(0.7, 2.0), rng)
        elif draw < 0.75:
            furniture.add_fence(site.builder, width - 1.2, rng)
    for _ in range(int(rng.integers(0, 1 + width / 7))):
        site.tree(x + rng.uniform(1, width - 1), edge + rng.uniform(0.3, 1.0) * depth, section.kerb_m * 0.9)
