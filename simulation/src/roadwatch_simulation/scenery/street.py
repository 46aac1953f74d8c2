"""A straight street along x through the origin."""

from __future__ import annotations

import math

from .frontage import line_road_side
from .layout import Place
from .section import Section, add_centre_line, add_road_side, add_zebra, draw_section
from .site import Site
from .skyline import add_surroundings

SPAN_M = (-90.0, 150.0)
"""How far the street is built out, behind and ahead of the origin."""


def build_street(seed: int) -> Place:
    """A street with both its sides, as the seed has it."""
    site = Site("street", seed)
    section = draw_section(site.rng)
    add_surroundings(site, 190.0)
    _add_far_road(site, section)
    add_centre_line(site, section, SPAN_M)
    if site.rng.random() < 0.5:
        add_zebra(site, section, float(site.rng.uniform(12.0, 45.0)))
    for turned in (False, True):
        with site.builder.placed(sum(SPAN_M) if turned else 0.0, 0.0, math.pi if turned else 0.0):
            add_road_side(site, section, SPAN_M, stop_line=False)
            line_road_side(site, section, SPAN_M, SPAN_M[0], SPAN_M[1])
    return site.place()


def street_section(seed: int) -> Section:
    """The cross-section of the street with that seed, without building it."""
    return draw_section(Site("street", seed).rng)


def _add_far_road(site: Site, section: Section) -> None:
    for reach in ((SPAN_M[0] - 220.0, SPAN_M[0]), (SPAN_M[1], SPAN_M[1] + 220.0)):
        half = section.kerb_line_m
        site.builder.rectangles([[reach[0], -half]], [[reach[1], half]], -0.01, site.ground.road)
