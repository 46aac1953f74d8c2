"""Meshes as arrays, before Blender has them: axes x forward, y left, z up, origin in the box's middle."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Look:
    """A material: linear RGB, roughness and metallic 0 to 1. `TRACK` takes the track's colour."""

    name: str
    rgb: Vector
    roughness: float = 0.6
    metallic: float = 0.0


TRACK = Look("track", (0.5, 0.5, 0.5), 0.35)
DARK = Look("dark", (0.02, 0.022, 0.025), 0.5)
FOOTPRINT = Look("footprint", (0.10, 0.105, 0.115), 1.0)
GLASS = Look("glass", (0.03, 0.04, 0.05), 0.1)


@dataclass(frozen=True)
class Mesh:
    """Triangles over shared vertices.

    `vertices_m` is float32 (v, 3), `triangles` int32 (t, 3), `look_of` int32 (t,) into `looks`. `normals` is
    float32 (v, 3) for smooth shading, or None for flat. `size_lwh_m` is the box that the mesh fills.
    """

    vertices_m: np.ndarray
    triangles: np.ndarray
    look_of: np.ndarray
    looks: tuple[Look, ...]
    size_lwh_m: Vector
    normals: np.ndarray | None = None


@dataclass
class Builder:
    """Collects convex faces, then makes a flat-shaded mesh of them."""

    points: list[Sequence[float]] = field(default_factory=list)
    triangles: list[tuple[int, int, int]] = field(default_factory=list)
    look_of: list[int] = field(default_factory=list)
    looks: list[Look] = field(default_factory=list)

    def face(self, corners: Sequence[Sequence[float]], look: Look) -> None:
        """A convex face, counter-clockwise seen from outside."""
        if look not in self.looks:
            self.looks.append(look)
        first = len(self.points)
        self.points.extend(corners)
        for corner in range(1, len(corners) - 1):
            self.triangles.append((first, first + corner, first + corner + 1))
            self.look_of.append(self.looks.index(look))

    def cuboid(self, low: Sequence[float], high: Sequence[float], look: Look) -> None:
        """An axis-aligned cuboid from its lowest to its highest corner."""
        (x0, y0, z0), (x1, y1, z1) = low, high
        bottom = [(x0, y0, z0), (x1, y0, z0), (x1, y1, z0), (x0, y1, z0)]
        top = [(x0, y0, z1), (x1, y0, z1), (x1, y1, z1), (x0, y1, z1)]
        self.prism(bottom, top, look)

    def prism(self, bottom: Sequence[Vector], top: Sequence[Vector], look: Look) -> None:
        """A solid between two faces with as many corners, both counter-clockwise seen from the top."""
        self.face(list(reversed(bottom)), look)
        self.face(top, look)
        self.skin(bottom, top, [look] * len(bottom))

    def skin(self, lower: Sequence[Vector], upper: Sequence[Vector], looks: Sequence[Look]) -> None:
        """The sides between two rings, one look for each side."""
        count = len(lower)
        for side, look in enumerate(looks):
            after = (side + 1) % count
            self.face([lower[side], lower[after], upper[after], upper[side]], look)

    def finish(self, size_lwh_m: Vector) -> Mesh:
        """The mesh; `size_lwh_m` is what it says of itself, points are taken as they are."""
        return Mesh(
            np.array(self.points, dtype=np.float32).reshape(-1, 3),
            np.array(self.triangles, dtype=np.int32).reshape(-1, 3),
            np.array(self.look_of, dtype=np.int32),
            tuple(self.looks),
            size_lwh_m,
        )


def with_footprint(mesh: Mesh) -> Mesh:
    """The mesh and a dark patch on the ground under its box, by which it is seen to stand there."""
    length, width, height = (0.5 * extent for extent in mesh.size_lwh_m)
    patch = [
        (-length, -width, -height),
        (length, -width, -height),
        (length, width, -height),
        (-length, width, -height),
    ]
    first = len(mesh.vertices_m)
    normals = None
    if mesh.normals is not None:
        normals = np.vstack([mesh.normals, np.tile(np.float32([0.0, 0.0, 1.0]), (4, 1))])
    return Mesh(
        np.vstack([mesh.vertices_m, np.float32(patch)]),
        np.vstack([mesh.triangles, np.int32([[first, first + 1, first + 2], [first, first + 2, first + 3]])]),
        np.concatenate([mesh.look_of, np.int32([len(mesh.looks)] * 2)]),
        (*mesh.looks, FOOTPRINT),
        mesh.size_lwh_m,
        normals,
    )
