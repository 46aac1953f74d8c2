"""Trees and hedges: crowns of many small leaves around displaced dark cores."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from ..model import Material, Model, Surface
from .builder import MeshBuilder
from .palette import BARK, PALE_BARK, choice, leaves

TREE_KINDS = ("broad", "broad", "broad", "tall", "conifer", "young", "bare")
_OUTWARD_SHARE = 0.75
"""How far a leaf's normal leans towards the crown's own, which shades the crown as one body."""


def build_tree(seed: int, kind: str | None = None, *, far: bool = False) -> Model:
    """A tree, of a drawn kind where none is named; origin at its foot. A far one has fewer leaves."""
    rng = np.random.default_rng([seed, 101])
    return _tree(kind or choice(rng, TREE_KINDS), seed, far)


@lru_cache(maxsize=64)
def _tree(kind: str, seed: int, far: bool) -> Model:
    rng = np.random.default_rng([seed, 102])
    builder = FarTreeBuilder() if far else MeshBuilder()
    makers = {"broad": _broad, "tall": _tall, "conifer": _conifer, "young": _young, "bare": _bare}
    makers[kind](builder, rng)
    return builder.model(f"{kind} tree")


class FarTreeBuilder(MeshBuilder):
    """Keeps one leaf in three, as a tree far off needs no more."""

    def triangles(self, positions: np.ndarray, material: Material, normals: np.ndarray | None = None) -> None:
        """As the base class, thinning what comes in leaves of two triangles."""
        if material.name == "leaves" and normals is not None:
            keep = np.repeat(np.arange(len(positions) // 2) % 3 == 0, 2)
            positions, normals = positions[keep], normals[keep]
            middle = positions.mean(axis=1, keepdims=True)
            positions = middle + (positions - middle) * 1.6
        super().triangles(positions, material, normals)


def add_blob_of_leaves(
    builder: MeshBuilder, centre, radii, material: Material, rng: np.random.Generator, leaf_m: float,
    count: int,
) -> None:
    """Adds an ellipsoid of loose leaves with an opaque core."""
    centre, radii = np.asarray(centre, dtype=float), np.asarray(radii, dtype=float)
    outward = _sphere_points(rng, count)
    depth = rng.uniform(0.72, 1.12, (count, 1))
    add_leaves(builder, centre + outward * radii * depth, outward, material, rng, leaf_m)
    _add_core(builder, centre, radii * 0.84, _darker(material), rng)


def add_leaves(
    builder: MeshBuilder, at: np.ndarray, outward: np.ndarray, material: Material, rng: np.random.Generator,
    leaf_m: float,
) -> None:
    """Adds a kite-shaped tuft of leaves at each place, hanging at random around its outward direction."""
    count = len(at)
    facing = _unit(outward + rng.normal(0.0, 0.55, (count, 3)))
    along = _unit(np.cross(facing, rng.normal(0.0, 1.0, (count, 3))))
    across = np.cross(facing, along)
    size = leaf_m * rng.uniform(0.6, 1.4, (count, 1))
    tip, tail = at + along * size, at - along * size * rng.uniform(0.5, 1.0, (count, 1))
    left = at + across * size * rng.uniform(0.35, 0.8, (count, 1)) + facing * size * 0.2
    right = at - across * size * rng.uniform(0.35, 0.8, (count, 1)) + facing * size * 0.2
    normal = _unit(_OUTWARD_SHARE * outward + (1.0 - _OUTWARD_SHARE) * facing)
    corners = np.stack([tip, left, tail, tip, tail, right], 1).reshape(-1, 3, 3)
    normals = np.repeat(np.repeat(normal[:, None], 3, 1), 2, 0)
    builder.triangles(corners, material, normals)


def add_hedge(
    builder: MeshBuilder, length_m: float, width_m: float, height_m: float, rng: np.random.Generator,
    material: Material | None = None,
) -> None:
    """Adds a clipped hedge along x from the frame's origin."""
    material = material or leaves(rng, autumn_share=0.05)
    half = 0.5 * width_m
    builder.box((0, -half, 0), (length_m, half, height_m * 0.97), _darker(material))
    count = int(min(220, 9 * length_m * (height_m + 0.5 * width_m)))
    side = rng.integers(0, 3, count)
    x, z = rng.uniform(0, length_m, count), rng.uniform(0.05, height_m, count)
    y = np.choose(side, [np.full(count, -half), np.full(count, half), rng.uniform(-half, half, count)])
    z = np.where(side == 2, height_m, z)
    outward = np.array([[0, -1, 0.2], [0, 1, 0.2], [0, 0, 1.0]])[side]
    add_leaves(builder, np.stack([x, y, z], 1), outward, material, rng, 0.16)


def _broad(builder: MeshBuilder, rng: np.random.Generator) -> None:
    material = leaves(rng)
    height = rng.uniform(5.5, 11.0)
    crown = height * rng.uniform(0.26, 0.36)
    trunk = height * rng.uniform(0.28, 0.40)
    _trunk(builder, trunk + crown * 0.5, rng.uniform(0.12, 0.24), rng)
    middle = np.array([0.0, 0.0, trunk + crown * 0.85])
    for direction in np.concatenate([np.zeros((1, 3)), _sphere_points(rng, int(rng.integers(5, 8)))]):
        offset = direction * crown * np.array([0.75, 0.75, 0.55])
        radii = crown * rng.uniform(0.42, 0.68) * np.array([1.0, 1.0, rng.uniform(0.75, 1.0)])
        add_blob_of_leaves(builder, middle + offset, radii, material, rng, 0.055 * height**0.5 + 0.12, 66)


def _tall(builder: MeshBuilder, rng: np.random.Generator) -> None:
    material = leaves(rng)
    height = rng.uniform(8.0, 15.0)
    _trunk(builder, height * 0.5, 0.2, rng)
    for level in np.linspace(0.22, 0.9, 5):
        radius = height * 0.12 * (1.15 - abs(level - 0.45))
        offset = rng.normal(0.0, 0.15, 2)
        add_blob_of_leaves(
            builder, (*offset, level * height), (radius, radius, height * 0.11), material, rng, 0.28, 85
        )


def _conifer(builder: MeshBuilder, rng: np.random.Generator) -> None:
    material = leaves(rng, autumn_share=0.0)
    height, spread = rng.uniform(5.0, 13.0), rng.uniform(0.18, 0.27)
    _trunk(builder, height * 0.9, 0.18, rng)
    count = 420
    level = rng.uniform(0.0, 1.0, count) ** 1.4
    angle = rng.uniform(0.0, 2.0 * np.pi, count)
    layer = 0.75 + 0.25 * np.cos(level * 2.0 * np.pi * 9)
    radius = height * spread * (1.0 - level) * layer * rng.uniform(0.75, 1.05, count)
    radial = np.stack([np.cos(angle), np.sin(angle), np.full(count, 0.25)], 1)
    at = np.stack([radius * np.cos(angle), radius * np.sin(angle), height * (0.12 + 0.86 * level)], 1)
    add_leaves(builder, at, _unit(radial), material, rng, 0.30)
    foot = (0.0, 0.0, height * 0.14)
    builder.cylinder(foot, height * 0.8, height * spread * 0.72, _darker(material), sides=10,
        top_radius_m=0.03)


def _young(builder: MeshBuilder, rng: np.random.Generator) -> None:
    height = rng.uniform(3.2, 5.2)
    _trunk(builder, height * 0.65, 0.06, rng)
    material = leaves(rng)
    for _ in range(3):
        offset = rng.normal(0.0, 0.25, 3)
        radii = height * rng.uniform(0.13, 0.19) * np.array([1.0, 1.0, 1.2])
        add_blob_of_leaves(builder, offset + [0, 0, height * 0.72], radii, material, rng, 0.17, 70)


def _bare(builder: MeshBuilder, rng: np.random.Generator) -> None:
    height = rng.uniform(5.0, 10.0)
    bark = choice(rng, (BARK, PALE_BARK))
    _branch(builder, np.zeros(3), np.array([0.0, 0.0, height * 0.33]), 0.15, 0, bark, rng)


def _branch(builder, start, along, radius, depth, bark, rng) -> None:
    end = start + along
    _limb(builder, start, end, radius, radius * 0.68, bark, 6 if depth < 2 else 4)
    if depth >= 3:
        _twigs(builder, start, end, bark, rng)
        return
    for _ in range(4 if depth == 0 else 3):
        direction = _unit(along / np.linalg.norm(along) + rng.normal(0.0, 0.5, 3) + [0, 0, 0.12])
        length = np.linalg.norm(along) * rng.uniform(0.6, 0.85)
        _branch(builder, end, direction * length, radius * 0.55, depth + 1, bark, rng)


def _twigs(builder, start, end, bark, rng) -> None:
    """A spray of thin triangles around the end of a branch."""
    count = 9
    root = start + (end - start) * rng.uniform(0.2, 1.0, (count, 1))
    direction = _unit(_unit(end - start) + rng.normal(0.0, 0.55, (count, 3)))
    tip = root + direction * np.linalg.norm(end - start) * rng.uniform(0.4, 1.0, (count, 1))
    side = _unit(np.cross(direction, rng.normal(0.0, 1.0, (count, 3)))) * 0.014
    builder.triangles(np.stack([root - side, root + side, tip], 1), bark)


def _limb(builder, start, end, radius, end_radius, bark, sides) -> None:
    along = _unit(end - start)
    side = _unit(np.cross(along, [0.3, 0.9, 0.1]))
    other = np.cross(along, side)
    angle = np.linspace(0, 2 * np.pi, sides + 1)
    ring = np.cos(angle)[:, None] * side + np.sin(angle)[:, None] * other
    low, high = start + ring * radius, end + ring * end_radius
    builder.quads(np.stack([low[:-1], low[1:], high[1:], high[:-1]], 1), bark)


def _trunk(builder: MeshBuilder, height: float, radius: float, rng: np.random.Generator) -> None:
    bark = choice(rng, (BARK, BARK, PALE_BARK))
    builder.cylinder((0, 0, 0), height, radius * 1.15, bark, sides=7, top_radius_m=radius * 0.6)


def _add_core(builder: MeshBuilder, centre, radii, material: Material, rng: np.random.Generator) -> None:
    """A lumpy ball (7 x 4 facets) that light does not pass."""
    rows, columns = 4, 7
    tilt = np.linspace(0.0, np.pi, rows + 1)[:, None]
    turn = np.linspace(0.0, 2.0 * np.pi, columns + 1)[None]
    unit = np.stack([np.sin(tilt) * np.cos(turn), np.sin(tilt) * np.sin(turn),
                     np.broadcast_to(np.cos(tilt), (rows + 1, columns + 1))], -1)
    lumps = rng.uniform(0.82, 1.08, (rows + 1, columns + 1, 1))
    lumps[:, -1], lumps[0], lumps[-1] = lumps[:, 0], 1.0, 1.0
    grid = centre + unit * lumps * radii
    corners = np.stack([grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]], 2).reshape(-1, 4, 3)
    normal = np.stack([unit[:-1, :-1], unit[1:, :-1], unit[1:, 1:], unit[:-1, 1:]], 2).reshape(-1, 4, 3)
    split = [0, 1, 2, 0, 2, 3]
    builder.triangles(corners[:, split].reshape(-1, 3, 3), material, normal[:, split].reshape(-1, 3, 3))


def _darker(material: Material) -> Material:
    red, green, blue = material.colour
    return Material("inner leaves", (red * 0.55, green * 0.55, blue * 0.55), surface=Surface.FOLIAGE)


def _sphere_points(rng: np.random.Generator, count: int) -> np.ndarray:
    return _unit(rng.normal(0.0, 1.0, (count, 3)))


def _unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-9)
