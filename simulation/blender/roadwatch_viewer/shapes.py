"""What the viewer draws beside models: box edges, arrows, blocks, pawns, camera cones."""

from __future__ import annotations

import math

from .mesh import DARK, TRACK, Builder, Look, Mesh, Vector

EDGE_SHARE = 0.022
"""Thickness of a box's edges as a share of its height and width together, halved."""
DASH_M = 0.35
ARROW_AHEAD_M = 1.4
GRID_LINE_M = 0.06
UNKNOWN = Look("unknown heading", (0.80, 0.80, 0.78), 0.8)


def edges(size_lwh_m: Vector, *, dashed: bool) -> Mesh:
    """The twelve edges of a cuboid as bars inside it; dashed ones say that the heading is not known."""
    builder = Builder()
    _, width, height = size_lwh_m
    half = [extent / 2.0 for extent in size_lwh_m]
    bar = min(max(EDGE_SHARE * (width + height), 0.025), min(size_lwh_m) / 4.0)
    for axis in range(3):
        across = [other for other in range(3) if other != axis]
        for first in (-1.0, 1.0):
            for second in (-1.0, 1.0):
                for start, end in _spans(half[axis] - (bar if axis else 0.0), dashed):
                    low, high = [0.0] * 3, [0.0] * 3
                    low[axis], high[axis] = start, end
                    for other, sign in zip(across, (first, second), strict=True):
                        inner, outer = sign * (half[other] - bar), sign * half[other]
                        low[other], high[other] = min(inner, outer), max(inner, outer)
                    builder.cuboid(low, high, TRACK)
    return builder.finish(size_lwh_m)


def _spans(half: float, dashed: bool) -> list[tuple[float, float]]:
    """From where to where an edge's bars go."""
    if not dashed:
        return [(-half, half)]
    # An odd number of equal pieces, every other one drawn: corners are always drawn.
    pieces = 2 * max(round(half / DASH_M), 1) + 1
    step = 2.0 * half / pieces
    return [(-half + step * piece, -half + step * (piece + 1)) for piece in range(0, pieces, 2)]


def arrow(size_lwh_m: Vector) -> Mesh:
    """An arrow over the box along +x, from its middle to beyond its front."""
    length, width, height = size_lwh_m
    shaft, head, thick = 0.055 * width + 0.03, 0.16 * width + 0.10, 0.05 * width + 0.03
    low = height / 2.0 + 0.08
    tip = length / 2.0 + min(ARROW_AHEAD_M, 0.6 * length)
    neck = tip - 2.0 * head
    outline = [
        (0.0, -shaft),
        (neck, -shaft),
        (neck, -head),
        (tip, 0.0),
        (neck, head),
        (neck, shaft),
        (0.0, shaft),
    ]
    builder = Builder()
    # The outline is not convex: a shaft and a head, each of which is.
    for part in (outline[:2] + outline[5:], outline[2:5]):
        bottom = [(x, y, low) for x, y in part]
        builder.prism(bottom, [(x, y, low + thick) for x, y in part], TRACK)
    return builder.finish(size_lwh_m)


def block(size_lwh_m: Vector) -> Mesh:
    """A plain cuboid, a tenth smaller than its box, white: it says nothing of what it is or points to."""
    half = [0.45 * extent for extent in size_lwh_m]
    builder = Builder()
    builder.cuboid([-extent for extent in half], half, UNKNOWN)
    return builder.finish(size_lwh_m)


def pawn(size_lwh_m: Vector, segments: int = 10) -> Mesh:
    """A standing figure without a front: a cone with a head, in the track's colour."""
    length, width, height = size_lwh_m
    # Radius and height, as shares: foot, waist, shoulder, neck, and four rings of the head.
    profile = [
        (0.36, 0.0), (0.36, 0.05), (0.30, 0.45), (0.44, 0.78), (0.16, 0.84),
        (0.22, 0.88), (0.24, 0.93), (0.16, 0.98), (0.02, 1.0),
    ]  # fmt: skip
    rings = []
    for radius, up in profile:
        turns = [2.0 * math.pi * step / segments for step in range(segments)]
        rings.append([
            (radius * length * math.cos(turn), radius * width * math.sin(turn), (up - 0.5) * height)
            for turn in turns
        ])  # fmt: skip
    builder = Builder()
    builder.face(list(reversed(rings[0])), TRACK)
    for lower, upper in zip(rings, rings[1:], strict=False):
        builder.skin(lower, upper, [TRACK] * segments)
    builder.face(rings[-1], TRACK)
    return builder.finish(size_lwh_m)


def cone(width_px: int, height_px: int, focal_px: tuple[float, float], reach_m: float) -> Mesh:
    """What a camera sees, as thin bars in its optical frame, from its centre to `reach_m`."""
    right, down = (
        0.5 * side / focal * reach_m for side, focal in zip((width_px, height_px), focal_px, strict=True)
    )
    corners = [
        (-right, -down, reach_m),
        (right, -down, reach_m),
        (right, down, reach_m),
        (-right, down, reach_m),
    ]
    builder = Builder()
    for corner, after in zip(corners, corners[1:] + corners[:1], strict=True):
        _bar(builder, (0.0, 0.0, 0.0), corner)
        _bar(builder, corner, after)
    return builder.finish((2.0 * right, 2.0 * down, reach_m))


def _bar(builder: Builder, start: Vector, end: Vector, half_m: float = 0.012) -> None:
    """A thin square rod, its sides along x and y or, where it lies along those, y and z."""
    along = [abs(b - a) for a, b in zip(start, end, strict=True)]
    first, second = sorted(range(3), key=lambda axis: along[axis])[:2]
    rings = []
    for point in (start, end):
        ring = []
        for one, two in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
            corner = list(point)
            corner[first] += one * half_m
            corner[second] += two * half_m
            ring.append(tuple(corner))
        rings.append(ring)
    builder.prism(rings[0], rings[1], DARK)


def grid(half_m: float, step_m: float) -> Mesh:
    """A level grid of strips, seen from above and below."""
    builder = Builder()
    look = Look("grid", (0.16, 0.17, 0.19), 1.0)
    count = round(half_m / step_m)
    for line in range(-count, count + 1):
        near, far = line * step_m - GRID_LINE_M / 2.0, line * step_m + GRID_LINE_M / 2.0
        for low, high in (((-half_m, near), (half_m, far)), ((near, -half_m), (far, half_m))):
            (x0, y0), (x1, y1) = low, high
            builder.face([(x0, y0, 0.0), (x1, y0, 0.0), (x1, y1, 0.0), (x0, y1, 0.0)], look)
    return builder.finish((2.0 * half_m, 2.0 * half_m, 0.01))


def ground(half_m: float) -> Mesh:
    """A level square."""
    builder = Builder()
    corners = [(-half_m, -half_m, 0.0), (half_m, -half_m, 0.0), (half_m, half_m, 0.0), (-half_m, half_m, 0.0)]
    builder.face(corners, Look("ground", (0.42, 0.43, 0.44), 1.0))
    return builder.finish((2.0 * half_m, 2.0 * half_m, 0.01))


def vehicle(size_lwh_m: Vector) -> Mesh:
    """The rig's own car in dark grey: a wedge of a body with a cabin, ahead recognisable."""
    length, width, height = (0.5 * extent for extent in size_lwh_m)
    look, roof = Look("own vehicle", (0.20, 0.22, 0.26), 0.4), Look("own cabin", (0.06, 0.07, 0.09), 0.2)
    belt, sill = 0.12 * height, -0.75 * height
    builder = Builder()

    def ring(front: float, back: float, half: float, z: float) -> list[Vector]:
        return [(back, -half, z), (front, -half, z), (front, half, z), (back, half, z)]

    builder.prism(ring(length, -length, width, sill), ring(0.93 * length, -length, 0.97 * width, belt), look)
    cabin = ring(0.42 * length, -0.9 * length, 0.93 * width, belt)
    builder.prism(cabin, ring(0.05 * length, -0.62 * length, 0.76 * width, height), roof)
    for x in (0.6 * length, -0.6 * length):
        for y in (-width, width - 0.22):
            builder.cuboid((x - 0.32, y, -height), (x + 0.32, y + 0.22, sill + 0.3), DARK)
    return builder.finish(size_lwh_m)
