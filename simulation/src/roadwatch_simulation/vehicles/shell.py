"""The painted shell of a car: cross-sections lofted from tail to nose, with wheel arches and windows."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import PchipInterpolator

from roadwatch_simulation.assembly import Size
from roadwatch_simulation.geometry import Patch, grid_faces, shade_faces
from roadwatch_simulation.vehicles.shapes import BodyShape, Knots, Span

ARCH_OVER_WHEEL = 1.15
"""Radius of the wheel arch against the wheel's."""

HALF_POINTS = 16
"""Points of half a cross-section, from under the floor to the middle of the roof."""

# Bands of the half section, named by the point at which each begins.
FLOOR, WELL, SILL_EDGE, SILL = 0, 1, 2, 3
PILLAR_FOOT, GLASS_LOW, GLASS_HIGH, ROOF_OUTER, ROOF_INNER = 8, 9, 10, 13, 14


@dataclass(frozen=True)
class Frame:
    """One car's own shape: a body style with its seed's variations, at its size (m)."""

    shape: BodyShape
    size: Size
    roof_line: PchipInterpolator
    belt_line: PchipInterpolator
    plan: PchipInterpolator
    warp: PchipInterpolator
    wheel_radius: float

    def x(self, u: float) -> float:
        """Distance ahead of the middle (m) of a place along the body style."""
        return self.size[0] * (0.5 - float(self.warp(u)))

    def u(self, x: float) -> float:
        """The place along the body style of a distance ahead of the middle."""
        us = np.linspace(0.0, 1.0, 401)
        return float(np.interp(0.5 - x / self.size[0], self.warp(us), us))

    def roof(self, u: float) -> float:
        """Height (m) of the top at `u`."""
        return float(self.roof_line(u)) * self.size[2]

    def belt(self, u: float) -> float:
        """Height (m) of the lower edge of the side windows at `u`."""
        return min(float(self.belt_line(u)) * self.size[2], self.roof(u) - 0.012 * self.size[2])

    def half_width(self, u: float) -> float:
        """Half the body's width (m) at `u`."""
        return self.size[1] / 2.0 * float(self.plan(self.warp(u)))

    def floor(self, u: float) -> float:
        """Height (m) of the body's underside at `u`: it lifts towards the bumpers."""
        x, (front, rear) = self.x(u), self.axles
        beyond = max(x - front - self.arch_radius, rear - self.arch_radius - x, 0.0)
        return self.shape.clearance_m + min(0.14 * beyond, 0.07)

    @property
    def axles(self) -> tuple[float, float]:
        """Where the front and the rear axle stand (m ahead of the middle)."""
        return self.x(self.shape.wheels[0]), self.x(self.shape.wheels[1])

    @property
    def arch_radius(self) -> float:
        """Radius of the wheel arches (m)."""
        return self.wheel_radius * ARCH_OVER_WHEEL


def draw_frame(shape: BodyShape, size: Size, rng: np.random.Generator) -> Frame:
    """Varies a body style: cowl, roof and tail shift along the car, nose, belt and boot rise or fall."""
    shifts = rng.uniform(-1.0, 1.0, 3) * np.array([0.016, 0.014, 0.012])
    warp = PchipInterpolator([0.0, 0.08, 0.28, 0.45, 0.75, 0.97, 1.0],
                             [0.0, 0.08, 0.28 + shifts[0], 0.45 + shifts[1], 0.75 + shifts[2], 0.97, 1.0])
    nose, belt, boot = rng.uniform(-1.0, 1.0, 3) * np.array([0.022, 0.012, 0.018])
    lift = PchipInterpolator([0.0, 0.05, 0.27, 0.6, 0.9, 1.0], [nose, nose, belt, belt, boot, boot])
    roof = [(u, z if z > 0.9 else z + float(lift(u)) * min(1.0, (0.9 - z) / 0.1)) for u, z in shape.roof_line]
    belts = [(u, z + float(lift(u))) for u, z in shape.belt_line]
    return Frame(
        shape, size, _curve(roof), _curve(belts), _curve(shape.plan), warp,
        float(rng.uniform(*shape.wheel_radius_m)) * size[2] / np.mean(shape.height_m),
    )  # fmt: skip


def _curve(knots: Knots | list[tuple[float, float]]) -> PchipInterpolator:
    return PchipInterpolator(*np.array(knots, dtype=float).T)


@dataclass(frozen=True)
class Shell:
    """The skin of a car with, for each triangle, what it is made of: `kinds` holds "paint", "glass", ..."""

    patch: Patch
    kinds: np.ndarray

    def painted(self, rear_x: float, front_x: float) -> Patch:
        """The painted triangles whose middles lie between two places (m ahead of the car's middle)."""
        middle = self.patch.positions[:, :, 0].mean(axis=1)
        return self.patch.chosen((middle >= rear_x) & (middle <= front_x) & (self.kinds == "paint"))


def build_shell(frame: Frame) -> Shell:
    """The lofted skin of a car."""
    stations = _stations(frame)
    halves = [_half_section(frame, u) for u in stations]
    rings = []
    for u, half in zip(stations, halves, strict=True):
        x = np.full((len(half), 1), frame.x(u))
        left = np.hstack([x, half])
        rings.append(np.concatenate([left, (left * [1, -1, 1])[-2:0:-1]]))
    size = 2 * HALF_POINTS - 2
    faces: list[tuple[int, ...]] = list(grid_faces(len(rings), size, wrap=True))
    kinds = [
        _kind(frame, (stations[row], stations[row + 1]), band if band < HALF_POINTS - 1 else size - 1 - band)
        for row in range(len(rings) - 1)
        for band in range(size)
    ]
    faces += [tuple(reversed(range(size))), tuple(range((len(rings) - 1) * size, len(rings) * size))]
    patch, origin = shade_faces(np.concatenate(rings), faces)
    return Shell(patch, np.array([*kinds, "paint", "paint"])[origin])


def _stations(frame: Frame) -> list[float]:
    """Places (u) of the cross-sections, from tail to nose: finer at the ends, the arches and the windows."""
    shape = frame.shape
    places = {*np.linspace(0.0, 1.0, 15), 0.003, 0.008, 0.016, 0.025, 0.035, 0.05, 0.97, 0.98, 0.988, 0.994}
    places |= {u for u, _ in shape.roof_line}
    for span in (*shape.side_windows, shape.windscreen, shape.rear_window, shape.bed):
        places |= set(span or ())
    if shape.bed:
        places |= {shape.bed[0] - 0.002, shape.bed[1] + 0.002}
    for axle in frame.axles:
        angles = np.linspace(0.0, np.pi, 11)
        places |= {frame.u(axle + frame.arch_radius * float(np.cos(angle))) for angle in angles}
        places |= {frame.u(axle + side * (frame.arch_radius + 0.004)) for side in (-1, 1)}
    ordered = sorted(float(np.clip(place, 0.0, 1.0)) for place in places)
    kept = [0.0]
    for place in ordered:
        if place - kept[-1] > 6e-4:
            kept.append(place)
    kept[-1] = 1.0
    return kept[::-1]


def _half_section(frame: Frame, u: float) -> np.ndarray:
    """Half a cross-section (HALF_POINTS, 2) of (y, z) in metres, from the floor's to the roof's middle."""
    height, width = frame.size[2], frame.half_width(u)
    roof, belt = frame.roof(u), frame.belt(u)
    floor = frame.floor(u)
    sill, arched = _sill_height(frame, u, floor)
    sill = min(sill, belt - 0.03)
    well = max(floor, 0.55 * sill) if arched else floor
    cabin = float(np.clip((roof - belt) / (0.97 * height - belt), 0.0, 1.0))
    edge = min(1.0, (roof - belt) / (0.05 * height))
    glazed = cabin > 0.08
    roof_y = width * (0.93 + (frame.shape.roof_width - 0.93) * cabin)
    roof_z = max(roof - (0.045 if glazed else 0.012) * height * edge, belt + 0.004)
    middle = sill + (belt - sill) * 0.45
    body = [
        (0.0, well), (0.80 * width, well), (0.81 * width, sill), (0.968 * width, sill),
        (0.990 * width, sill + (middle - sill) * 0.30), (width, middle),
        (0.997 * width, belt - (belt - middle) * 0.30), (0.974 * width, belt - 0.018 * height),
        (0.945 * width, belt),
    ]  # fmt: skip
    foot, top = np.array(body[-1]), np.array([roof_y, roof_z])
    sides = [tuple(foot + (top - foot) * share) for share in (0.06, 0.5, 0.92, 1.0)]
    sides[1] = (sides[1][0] + 0.014 * width * cabin, sides[1][1])
    return np.array([*body, *sides, *_top_points(frame, u, (roof_y, roof_z), roof, glazed, edge)])


def _top_points(
    frame: Frame, u: float, side: tuple[float, float], roof: float, glazed: bool, edge: float
) -> list[tuple[float, float]]:
    """The three last points of a half section: roof, bonnet, boot, or the floor of a pickup's bed."""
    bed = frame.shape.bed
    if bed and bed[0] - 1e-6 <= u <= bed[1] + 1e-6:
        floor = frame.shape.clearance_m + 0.42
        return [(side[0] * 0.92, roof), (side[0] * 0.91, floor), (0.0, floor)]
    drop = (0.014 if glazed else 0.008) * frame.size[2] * edge
    return [(side[0] * 0.93, roof - drop), (side[0] * 0.55, roof - drop * 0.2), (0.0, roof)]


def _sill_height(frame: Frame, u: float, floor: float) -> tuple[float, bool]:
    """Height (m) of the body's lower edge, and whether it is inside a wheel arch."""
    x = frame.x(u)
    for axle in frame.axles:
        away = abs(x - axle)
        if away < frame.arch_radius:
            return max(floor, frame.wheel_radius + float(np.sqrt(frame.arch_radius**2 - away**2))), True
    return floor, False


def _kind(frame: Frame, span: Span, band: int) -> str:
    """What a face of the loft is made of, from where it lies along the car and around the section."""
    shape, (low, high) = frame.shape, (min(span), max(span))
    if band <= SILL_EDGE:
        return "underbody"
    if band == SILL and shape.rugged:
        return "plastic"
    if band in (ROOF_OUTER, ROOF_INNER):
        if _within(low, high, shape.windscreen):
            return "glass"
        if shape.rear_window and _within(low, high, shape.rear_window):
            return "rear glass"
        if shape.bed and _within(low, high, (shape.bed[0] - 0.003, shape.bed[1] + 0.003)):
            return "plastic"
    if band in (GLASS_LOW, GLASS_HIGH):
        for number, window in enumerate(shape.side_windows):
            if _within(low, high, window):
                return "glass" if number == 0 else "rear glass"
    glasshouse = (shape.side_windows[0][0], shape.side_windows[-1][1])
    if band in (PILLAR_FOOT, GLASS_LOW, GLASS_HIGH) and _within(low, high, glasshouse):
        return "trim"
    return "paint"


def _within(low: float, high: float, span: Span) -> bool:
    return low >= span[0] - 1e-6 and high <= span[1] + 1e-6
