"""Our parametric models as meshes of this viewer: from roadwatch_simulation, their single source.

The add-on's zip has the finished meshes in a file instead, for Blender's Python has no SciPy.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from . import shapes
from .errors import ViewerError
from .mesh import DARK, GLASS, TRACK, Builder, Look, Mesh, Vector

if TYPE_CHECKING:
    from roadwatch_simulation.model import Material, Model
    from roadwatch_simulation.vehicles.shapes import BodyShape

SEED = 4
MARK = (0.501, 0.502, 0.503)
"""A colour that no model has of itself: what has it is what takes the track's colour."""
SAME_PLACE_M = 1e-4


def build_model(kind: str, detail: str) -> Mesh:
    """The mesh of one of `kinds.MODELS`, `full` or `simple`. Raises ViewerError without the simulation."""
    try:
        from roadwatch_simulation import catalogue
    except ImportError as error:
        raise ViewerError(
            f"the viewer has no meshes and cannot build them ({error}): "
            "use the add-on's zip, or `pip install ./simulation ./simulation/blender`"
        ) from error
    model = catalogue.build(kind, SEED, colour=MARK)
    return _mesh_of(model) if detail == "full" else _simple(kind, model.size_lwh_m)


def _mesh_of(model: Model) -> Mesh:
    """The model with equal corners made one, its origin moved to the middle of its box."""
    middle = np.array([0.0, 0.0, model.size_lwh_m[2] / 2.0])
    positions = model.mesh.positions.reshape(-1, 3) - middle
    normals = model.mesh.normals.reshape(-1, 3)
    rounded = np.hstack([np.round(positions / SAME_PLACE_M), np.round(normals * 100.0)]).astype(np.int64)
    _, first, inverse = np.unique(rounded, axis=0, return_index=True, return_inverse=True)
    looks = tuple(dict.fromkeys(_look_of(material) for material in model.materials))
    index = np.array([looks.index(_look_of(material)) for material in model.materials], dtype=np.int32)
    return Mesh(
        positions[first].astype(np.float32),
        inverse.reshape(-1, 3).astype(np.int32),
        index[model.mesh.materials],
        looks,
        model.size_lwh_m,
        normals[first].astype(np.float32),
    )


def _look_of(material: Material) -> Look:
    if material.colour == MARK:
        return TRACK
    rgb = tuple(round(channel, 4) for channel in material.colour)
    return Look(material.name, rgb, round(1.0 - 0.8 * material.gloss, 3), material.metallic)


def _simple(kind: str, size: Vector) -> Mesh:
    """A few dozen faces from the body style's own side view; people and riders are pawns."""
    from roadwatch_simulation.vehicles.shapes import BUS_SHAPE, CAB_SHAPE, SHAPES

    if kind in ("pedestrian", "bicycle", "motorcycle"):
        return shapes.pawn(size, segments=6)
    if kind == "truck":
        return _simple_lorry(CAB_SHAPE, size)
    return _simple_body(BUS_SHAPE if kind == "bus" else SHAPES[kind], size)


def _simple_body(shape: BodyShape, size: Vector) -> Mesh:
    builder = Builder()
    _add_body(builder, shape, size, front_x=size[0] / 2.0, length=size[0])
    for u in shape.wheels:
        _add_axle(builder, size, size[0] * (0.5 - u), sum(shape.wheel_radius_m) / 2.0)
    return builder.finish(size)


def _simple_lorry(cab: BodyShape, size: Vector) -> Mesh:
    length, width, height = size
    cab_length = 0.32 * length
    builder = Builder()
    _add_body(builder, cab, (cab_length, width, 0.88 * height), length / 2.0, cab_length)
    back = length / 2.0 - cab_length - 0.12
    floor = -height / 2.0
    white = Look("case", (0.62, 0.62, 0.61), 0.6)
    low = (-length / 2.0, -width / 2.0, floor + 0.35 * height)
    builder.cuboid(low, (back, width / 2.0, height / 2.0), white)
    builder.cuboid((-length / 2.0, -0.4 * width, floor + 0.2 * height), (back, 0.4 * width, low[2]), DARK)
    for x in (0.33 * length, -0.3 * length):
        _add_axle(builder, size, x, 0.42)
    return builder.finish(size)


def _add_body(builder: Builder, shape: BodyShape, size: Vector, front_x: float, length: float) -> None:
    """Rings of six points (sills, belts, roof edges) from tail to nose, glass between belt and roof."""
    us = sorted({u for u, _ in shape.roof_line} | set(shape.wheels), reverse=True)
    rings = [_ring(shape, size, u, front_x - u * length) for u in us]
    builder.face(list(reversed(rings[0])), TRACK)
    builder.face(rings[-1], TRACK)
    spans = [shape.windscreen, *([shape.rear_window] if shape.rear_window else [])]
    side = (min(low for low, _ in shape.side_windows), max(high for _, high in shape.side_windows))
    for ring, next_ring, u, after in zip(rings, rings[1:], us, us[1:], strict=False):
        middle = 0.5 * (u + after)
        pane = GLASS if side[0] <= middle <= side[1] else TRACK
        roof = GLASS if any(low <= middle <= high for low, high in spans) else TRACK
        builder.skin(ring, next_ring, [TRACK, pane, roof, pane, TRACK, DARK])


def _ring(shape: BodyShape, size: Vector, u: float, x: float) -> list[Vector]:
    """Counter-clockwise seen from the nose, from the left sill over the roof to the right one."""
    _, width, height = size
    roof = _at(shape.roof_line, u) * height
    belt = min(_at(shape.belt_line, u) * height, 0.985 * roof)
    half = _at(shape.plan, u) * width / 2.0
    narrow = half * (shape.roof_width if roof > 1.25 * belt else 0.94)
    sill, floor = min(shape.clearance_m, 0.5 * belt), height / 2.0
    left = [(half, sill), (half, belt), (narrow, roof)]
    right = [(-y, z) for y, z in reversed(left)]
    return [(x, y, z - floor) for y, z in left + right]


def _at(knots: tuple[tuple[float, float], ...], u: float) -> float:
    return float(np.interp(u, [knot[0] for knot in knots], [knot[1] for knot in knots]))


def _add_axle(builder: Builder, size: Vector, x: float, radius: float) -> None:
    """Two wheels as octagons, their outer sides flush with the body."""
    floor, tread = -size[2] / 2.0, 0.22
    for outer in (size[1] / 2.0, -size[1] / 2.0):
        turns = [2.0 * np.pi * step / 8 for step in range(8)]
        inner = outer - np.sign(outer) * tread
        right, left = min(inner, outer), max(inner, outer)
        rings = [
            [(x + radius * float(np.sin(t)), y, floor + radius * (1.0 + float(np.cos(t)))) for t in turns]
            for y in (right, left)
        ]
        builder.prism(rings[0], rings[1], DARK)
