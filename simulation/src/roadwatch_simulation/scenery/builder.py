"""Collects the triangles of scenery, material by material, and cuts them into pieces a renderer can skip."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

from ..model import Instance, Material, Mesh, Model

CELL_M = 30.0
"""Side of the squares into which scenery is cut: small enough that most lie behind a camera."""
FAR_M = 120.0
FAR_CELL_M = 200.0
"""What lies beyond FAR_M is little and cut coarsely."""

# Corners of a box as bits (x, y, z) of the upper side, counter-clockwise seen from outside.
_BOX_FACES = {
    "-x": ((0, 0, 0), (0, 0, 1), (0, 1, 1), (0, 1, 0)),
    "+x": ((1, 0, 0), (1, 1, 0), (1, 1, 1), (1, 0, 1)),
    "-y": ((0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)),
    "+y": ((0, 1, 0), (0, 1, 1), (1, 1, 1), (1, 1, 0)),
    "+z": ((0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)),
    "-z": ((0, 0, 0), (0, 1, 0), (1, 1, 0), (1, 0, 0)),
}
STANDING = ("-x", "+x", "-y", "+y", "+z")
"""Faces of a box that stands on the ground: its bottom is never seen."""
ALL_FACES = tuple(_BOX_FACES)


def pose(x_m: float, y_m: float, yaw_rad: float, z_m: float = 0.0) -> np.ndarray:
    """Rigid 4x4 transform of something that stands upright at a place, turned about z."""
    cos, sin = math.cos(yaw_rad), math.sin(yaw_rad)
    return np.array([[cos, -sin, 0, x_m], [sin, cos, 0, y_m], [0, 0, 1, z_m], [0, 0, 0, 1]], dtype=float)


class MeshBuilder:
    """Triangles being collected; lengths in metres, in the frame set by `placed`."""

    def __init__(self) -> None:
        self._positions: list[np.ndarray] = []
        self._normals: list[np.ndarray] = []
        self._material_of: list[np.ndarray] = []
        self._materials: dict[Material, int] = {}
        self._frame = np.eye(4)

    @contextmanager
    def placed(self, x_m: float, y_m: float, yaw_rad: float = 0.0, z_m: float = 0.0) -> Iterator[None]:
        """Everything added inside is given in a frame at this place of the current frame."""
        outer = self._frame
        self._frame = outer @ pose(x_m, y_m, yaw_rad, z_m)
        try:
            yield
        finally:
            self._frame = outer

    @property
    def frame(self) -> np.ndarray:
        """The current frame: 4x4 from the things being added to the builder's own axes."""
        return self._frame

    def triangles(self, positions: np.ndarray, material: Material, normals: np.ndarray | None = None) -> None:
        """Adds triangles (n, 3, 3); flat normals unless others are given."""
        positions = np.asarray(positions, dtype=float).reshape(-1, 3, 3)
        if normals is None:
            flat = _cross(positions[:, 1] - positions[:, 0], positions[:, 2] - positions[:, 0])
            length = np.sqrt(np.einsum("ij,ij->i", flat, flat))
            keep = length > 1e-9
            positions = positions[keep]
            normals = np.repeat((flat[keep] / length[keep, None])[:, None], 3, axis=1)
        index = self._materials.setdefault(material, len(self._materials))
        rotation, offset = self._frame[:3, :3], self._frame[:3, 3]
        self._positions.append((positions @ rotation.T + offset).astype(np.float32))
        self._normals.append((normals @ rotation.T).astype(np.float32))
        self._material_of.append(np.full(len(positions), index, dtype=np.int32))

    def quads(self, corners: np.ndarray, material: Material) -> None:
        """Adds four-cornered faces (n, 4, 3), counter-clockwise seen from outside."""
        corners = np.asarray(corners, dtype=float).reshape(-1, 4, 3)
        self.triangles(corners[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3, 3), material)

    def boxes(
        self, lower: np.ndarray, upper: np.ndarray, material: Material, faces: tuple[str, ...] = STANDING
    ) -> None:
        """Adds boxes along the axes between `lower` (n, 3) and `upper` (n, 3)."""
        lower = np.asarray(lower, dtype=float).reshape(-1, 1, 3)
        upper = np.asarray(upper, dtype=float).reshape(-1, 1, 3)
        if len(lower) == 0:
            return
        for face in faces:
            bits = np.array(_BOX_FACES[face], dtype=bool)
            self.quads(np.where(bits[None], upper, lower), material)

    def box(self, lower, upper, material: Material, faces: tuple[str, ...] = STANDING) -> None:
        """Adds one box along the axes."""
        self.boxes(np.array([lower]), np.array([upper]), material, faces)

    def ground(
        self, x_m: tuple[float, float], y_m: tuple[float, float], z_m: float, material: Material
    ) -> None:
        """Adds a level rectangle, in tiles no longer than a cell."""
        xs = np.linspace(*x_m, max(2, math.ceil((x_m[1] - x_m[0]) / CELL_M) + 1))
        ys = np.linspace(*y_m, max(2, math.ceil((y_m[1] - y_m[0]) / CELL_M) + 1))
        west, south = (grid.ravel() for grid in np.meshgrid(xs[:-1], ys[:-1]))
        east, north = (grid.ravel() for grid in np.meshgrid(xs[1:], ys[1:]))
        self.rectangles(np.stack([west, south], 1), np.stack([east, north], 1), z_m, material)

    def rectangles(self, lower: np.ndarray, upper: np.ndarray, z_m: float, material: Material) -> None:
        """Adds level rectangles between corners `lower` (n, 2) and `upper` (n, 2)."""
        lower = np.asarray(lower, dtype=float).reshape(-1, 2)
        upper = np.asarray(upper, dtype=float).reshape(-1, 2)
        height = np.full(len(lower), z_m)
        corner = [(lower[:, 0], lower[:, 1]), (upper[:, 0], lower[:, 1]), (upper[:, 0], upper[:, 1])]
        corner.append((lower[:, 0], upper[:, 1]))
        self.quads(np.stack([np.stack([x, y, height], 1) for x, y in corner], 1), material)

    def cylinder(
        self, foot, height_m: float, radius_m: float, material: Material, *, sides: int = 8, top_radius_m=None
    ) -> None:
        """Adds an upright round post from `foot` (x, y, z), closed at the top, tapering to `top_radius_m`."""
        top_radius_m = radius_m if top_radius_m is None else top_radius_m
        angle = np.linspace(0.0, 2.0 * np.pi, sides + 1)
        ring = np.stack([np.cos(angle), np.sin(angle), np.zeros(sides + 1)], 1)
        low = np.asarray(foot, dtype=float) + radius_m * ring
        high = np.asarray(foot, dtype=float) + [0, 0, height_m] + top_radius_m * ring
        sides_of = np.stack([low[:-1], low[1:], high[1:], low[:-1], high[1:], high[:-1]], 1).reshape(-1, 3, 3)
        round_normals = np.stack([ring[:-1], ring[1:], ring[1:], ring[:-1], ring[1:], ring[:-1]], 1)
        self.triangles(sides_of, material, round_normals.reshape(-1, 3, 3))
        centre = np.broadcast_to(np.asarray(foot, dtype=float) + [0, 0, height_m], (sides, 3))
        self.triangles(np.stack([centre, high[:-1], high[1:]], 1), material)

    def fan(self, centre, rim: np.ndarray, material: Material) -> None:
        """Adds a flat polygon, star-shaped about `centre`; its rim (n, 3) runs counter-clockwise."""
        rim = np.asarray(rim, dtype=float)
        centres = np.broadcast_to(np.asarray(centre, dtype=float), (len(rim) - 1, 3))
        self.triangles(np.stack([centres, rim[:-1], rim[1:]], 1), material)

    def model(self, label: str) -> Model:
        """Everything added, as one model."""
        return Model(label, self._mesh(), tuple(self._materials))

    def instances(self, label: str) -> list[Instance]:
        """Everything added, cut into cells."""
        mesh = self._mesh()
        middle = mesh.positions.mean(axis=1)[:, :2]
        far = np.abs(middle).max(axis=1) > FAR_M
        cell = np.floor(middle / np.where(far, FAR_CELL_M, CELL_M)[:, None]).astype(np.int64)
        key = (cell[:, 0] * 4096 + cell[:, 1]) * 2 + far
        order = np.argsort(key, kind="stable")
        cuts = np.flatnonzero(np.diff(key[order])) + 1
        materials = tuple(self._materials)
        return [
            Instance(Model(f"{label} {index}", _chosen(mesh, triangles), materials), np.eye(4))
            for index, triangles in enumerate(np.split(order, cuts))
        ]

    def _mesh(self) -> Mesh:
        material_of = np.concatenate(self._material_of)
        parts = np.zeros(len(material_of), dtype=np.int32)
        return Mesh(np.concatenate(self._positions), np.concatenate(self._normals), material_of, parts)


def _cross(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Rows' cross products; `np.cross` costs many times more on the short arrays used here."""
    x1, y1, z1 = first.T
    x2, y2, z2 = second.T
    return np.stack([y1 * z2 - z1 * y2, z1 * x2 - x1 * z2, x1 * y2 - y1 * x2], 1)


def _chosen(mesh: Mesh, triangles: np.ndarray) -> Mesh:
    return Mesh(
        mesh.positions[triangles], mesh.normals[triangles], mesh.materials[triangles], mesh.parts[triangles]
    )
