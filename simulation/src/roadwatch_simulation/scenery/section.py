"""The cross-section of a road and the surfaces and markings that follow from it.

One side of a road is described in its own frame: x along the road, y from the middle of the road outwards.
Traffic keeps to the right, so that on this side it travels towards -x.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from .palette import WHITE_PAINT, YELLOW_PAINT, choice
from .site import Site

MARKING_Z_M = 0.008
"""Paint lies this high: less flickers in the depth buffer at 60 m."""
PAINT_WIDTH_M = 0.12
PARALLEL_BAY_M = (6.0, 2.2)
ACROSS_BAY_M = (5.2, 2.55)
JUNCTION_APPROACH_M = 12.0
"""No parking this close to a junction."""


@dataclass(frozen=True)
class Section:
    """One road; lengths in metres. `parking` is `none`, `parallel` or `across`, on both sides."""

    lanes_each_way: int
    lane_width_m: float
    parking: str
    verge_m: float
    pavement_m: float
    kerb_m: float
    setback_m: float
    median_m: float
    style: str
    cycle_lane_m: float

    @property
    def parking_m(self) -> float:
        """Width of the parking strip."""
        return {"none": 0.0, "parallel": PARALLEL_BAY_M[1], "across": ACROSS_BAY_M[0]}[self.parking]

    @property
    def travelled_m(self) -> float:
        """From the middle of the road to the outer edge of the outermost lane."""
        return 0.5 * self.median_m + self.lanes_each_way * self.lane_width_m + self.cycle_lane_m

    @property
    def kerb_line_m(self) -> float:
        """From the middle of the road to the kerb."""
        return self.travelled_m + self.parking_m

    @property
    def pavement_line_m(self) -> float:
        """From the middle of the road to the inner edge of the pavement."""
        return self.kerb_line_m + self.verge_m

    @property
    def frontage_line_m(self) -> float:
        """From the middle of the road to the outer edge of the pavement."""
        return self.pavement_line_m + self.pavement_m

    @property
    def building_line_m(self) -> float:
        """From the middle of the road to the buildings."""
        return self.frontage_line_m + self.setback_m


def draw_section(rng: np.random.Generator, *, parking: bool = True) -> Section:
    """A road of the kind that towns have."""
    style = choice(rng, ("town", "town", "town", "house", "house", "tower", "hall", "park", "mixed"))
    setback = {"town": (0.0, 1.5), "tower": (1.0, 6.0), "house": (3.5, 8.0), "hall": (5.0, 14.0),
        "park": (6.0, 12.0),
               "mixed": (0.5, 7.0)}[style]
    lanes = int(choice(rng, (1, 1, 1, 2, 2, 3)))
    options = ("none", "parallel", "parallel", "across") if lanes < 3 else ("none", "parallel")
    return Section(
        lanes_each_way=lanes,
        lane_width_m=float(rng.uniform(2.9, 3.6)),
        parking=choice(rng, options) if parking else "none",
        verge_m=float(rng.uniform(1.2, 3.0)) if rng.random() < 0.35 else 0.0,
        pavement_m=float(rng.uniform(1.8, 4.5)),
        kerb_m=float(rng.uniform(0.10, 0.16)),
        setback_m=float(rng.uniform(*setback)),
        median_m=float(rng.uniform(1.5, 3.5)) if lanes > 1 and rng.random() < 0.3 else 0.0,
        style=style,
        cycle_lane_m=1.6 if rng.random() < 0.2 else 0.0,
    )


def add_road_side(site: Site, section: Section, span: tuple[float, float], *, stop_line: bool) -> None:
    """Adds the surfaces and markings of one side of a road; with a stop line at the span's start if asked."""
    start, end = span
    site.road(span, (0.0, section.kerb_line_m))
    _add_kerb_and_pavement(site, section, span)
    _add_lines(site, section, span)
    _add_lanes(site, section, span)
    if stop_line:
        _paint(site, (start + 1.0, start + 1.45), (0.5 * section.median_m, section.travelled_m))
        for lane in range(section.lanes_each_way):
            _paint_arrow(site, start + 9.0, _lane_middle(section, lane))
    if section.parking != "none":
        margin = JUNCTION_APPROACH_M if stop_line else 2.0
        _add_bays(site, section, (start + margin, end - 2.0))
    _add_patches(site, section, span)


def add_zebra(site: Site, section: Section, at_m: float) -> None:
    """Paints a crossing over the whole road (both sides), centred at `at_m` along it."""
    reach = section.kerb_line_m
    edges = np.arange(-reach + 0.3, reach - 0.5, 1.0)
    lower = np.stack([np.full(len(edges), at_m - 1.6), edges], 1)
    upper = np.stack([np.full(len(edges), at_m + 1.6), edges + 0.5], 1)
    site.builder.rectangles(lower, upper, MARKING_Z_M, WHITE_PAINT)
    beyond = section.pavement_line_m + 0.5 * section.pavement_m
    site.crossing((at_m, -beyond), (at_m, beyond), 2.4)


def _lane_middle(section: Section, lane: int) -> float:
    return 0.5 * section.median_m + (lane + 0.5) * section.lane_width_m


def _paint(site: Site, x_m, y_m, material=WHITE_PAINT) -> None:
    site.builder.rectangles([[x_m[0], y_m[0]]], [[x_m[1], y_m[1]]], MARKING_Z_M, material)


def _dashes(site: Site, span, y_m: float, dash_m: float, gap_m: float, material=WHITE_PAINT) -> None:
    starts = np.arange(span[0] + 2.0, span[1] - dash_m, dash_m + gap_m)
    lower = np.stack([starts, np.full(len(starts), y_m - PAINT_WIDTH_M / 2)], 1)
    site.builder.rectangles(lower, lower + [dash_m, PAINT_WIDTH_M], MARKING_Z_M, material)


def _solid(site: Site, span, y_m: float, material=WHITE_PAINT) -> None:
    site.builder.ground(span, (y_m - PAINT_WIDTH_M / 2, y_m + PAINT_WIDTH_M / 2), MARKING_Z_M, material)


def _add_lines(site: Site, section: Section, span) -> None:
    rng = site.rng
    dash, gap = choice(rng, ((3.0, 6.0), (3.0, 9.0), (2.0, 4.0), (4.0, 8.0)))
    for lane in range(1, section.lanes_each_way):
        _dashes(site, span, 0.5 * section.median_m + lane * section.lane_width_m, dash, gap)
    if section.cycle_lane_m > 0.0:
        _solid(site, span, section.travelled_m - section.cycle_lane_m)
    if section.parking == "none" and rng.random() < 0.5:
        _solid(site, span, section.travelled_m - 0.25, choice(rng, (WHITE_PAINT, WHITE_PAINT, YELLOW_PAINT)))
    if section.median_m > 0.0:
        _solid(site, span, 0.5 * section.median_m + 0.2)


def add_centre_line(site: Site, section: Section, span: tuple[float, float]) -> None:
    """Adds what parts the two directions: a line, two lines, or a planted strip. In the road's own frame."""
    rng = site.rng
    if section.median_m > 0.0:
        half = 0.5 * section.median_m - 0.1
        site.slab((span[0] + 3.0, span[1]), (-half, half), section.kerb_m, site.ground.grass)
        for x in np.arange(span[0] + 8.0, span[1], 11.0):
            if rng.random() < 0.4:
                site.tree(float(x), 0.0, section.kerb_m)
        return
    material = choice(rng, (WHITE_PAINT, WHITE_PAINT, YELLOW_PAINT))
    style = choice(rng, ("dashed", "dashed", "solid", "double", "bare"))
    if style == "dashed":
        _dashes(site, span, 0.0, 3.0, 5.0, material)
    elif style == "solid":
        _solid(site, span, 0.0, material)
    elif style == "double":
        _solid(site, span, -0.14, material)
        _solid(site, span, 0.14, material)


def _paint_arrow(site: Site, x_m: float, y_m: float) -> None:
    """A straight-ahead arrow towards -x."""
    _paint(site, (x_m, x_m + 2.6), (y_m - 0.08, y_m + 0.08))
    head = [[x_m - 1.2, y_m, MARKING_Z_M], [x_m, y_m - 0.4, MARKING_Z_M], [x_m, y_m + 0.4, MARKING_Z_M]]
    site.builder.triangles(np.array([head]), WHITE_PAINT)


def _add_lanes(site: Site, section: Section, span) -> None:
    for lane in range(section.lanes_each_way):
        middle = _lane_middle(section, lane)
        site.lane((span[1], middle), (span[0], middle), section.lane_width_m)


def _add_kerb_and_pavement(site: Site, section: Section, span) -> None:
    kerb, verge = section.kerb_line_m, section.pavement_line_m
    site.builder.ground(span, (kerb - 0.25, kerb), 0.004, site.ground.patch)
    if section.verge_m > 0.0:
        site.slab(span, (kerb, verge), section.kerb_m, site.ground.grass)
        site.builder.ground(span, (kerb, kerb + 0.18), section.kerb_m + 0.01, site.ground.kerb)
    site.slab(span, (verge, section.frontage_line_m), section.kerb_m, site.ground.paving)
    if section.verge_m == 0.0:
        site.builder.ground(span, (kerb, kerb + 0.18), section.kerb_m + 0.005, site.ground.kerb)
    middle = 0.5 * (verge + section.frontage_line_m)
    site.walk((span[0], middle), (span[1], middle), section.pavement_m - 0.8)


def _add_bays(site: Site, section: Section, span) -> None:
    along = PARALLEL_BAY_M[0] if section.parking == "parallel" else ACROSS_BAY_M[1]
    middle = section.travelled_m + 0.5 * section.parking_m
    count = max(0, math.floor((span[1] - span[0]) / along))
    painted = site.rng.random() < 0.7
    nose_in = section.parking == "across"
    for index in range(count):
        x = span[0] + (index + 0.5) * along
        yaw = math.pi / 2 if nose_in else math.pi
        size = (section.parking_m, along) if nose_in else (along, section.parking_m)
        site.bay(x, middle, yaw, *size)
    if not painted or count == 0:
        return
    edges = span[0] + np.arange(count + 1) * along
    lower = np.stack([edges - 0.05, np.full(count + 1, section.travelled_m)], 1)
    site.builder.rectangles(lower, lower + [0.1, section.parking_m - 0.3], MARKING_Z_M, WHITE_PAINT)


def _add_patches(site: Site, section: Section, span) -> None:
    """Repairs, manholes and drains: roads are never of one piece."""
    rng = site.rng
    for _ in range(int(rng.integers(1, 7))):
        x, y = rng.uniform(span[0], span[1] - 6.0), rng.uniform(0.0, max(0.5, section.travelled_m - 2.0))
        site.builder.rectangles([[x, y]], [[x + rng.uniform(0.5, 6.0), y + rng.uniform(0.5, 1.8)]], 0.004,
                                site.ground.patch)
    for x in rng.uniform(span[0], span[1], 4):
        y = rng.uniform(0.3, section.travelled_m - 0.6)
        angle = np.linspace(0.0, 2.0 * np.pi, 13)
        rim = np.stack([x + 0.33 * np.cos(angle), y + 0.33 * np.sin(angle), np.full(13, 0.006)], 1)
        site.builder.fan((x, y, 0.006), rim, site.ground.patch)
