"""Building blocks of every model: triangles with smooth normals, lathed, lofted and boxed shapes.

Everything here is metres, counter-clockwise seen from outside, and knows nothing of materials or parts.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import product

import numpy as np
from scipy.spatial import ConvexHull

SMOOTH_BELOW_DEG = 38.0
"""Neighbouring faces that meet at less than this angle are shaded as one curved surface."""

SMALLEST_AREA_M2 = 1e-10
"""Triangles below this are slivers of a collapsed quad and are dropped."""

Faces = Sequence[Sequence[int]]


@dataclass(frozen=True)
class Patch:
    """Triangles: `positions` (m) and unit `normals`, both (n, 3, 3) as triangle, corner, axis."""

    positions: np.ndarray
    normals: np.ndarray

    def moved(self, offset: Sequence[float]) -> Patch:
        """The same patch shifted by `offset` (m)."""
        return Patch(self.positions + np.asarray(offset, dtype=float), self.normals)

    def turned(self, rotation: np.ndarray) -> Patch:
        """The same patch turned about the origin by a 3x3 rotation."""
        return Patch(self.positions @ rotation.T, self.normals @ rotation.T)

    def scaled(self, factors: Sequence[float]) -> Patch:
        """The same patch stretched along the axes about the origin; `factors` are above 0."""
        factors = np.asarray(factors, dtype=float)
        return Patch(self.positions * factors, _unit(self.normals / factors))

    def mirrored(self) -> Patch:
        """The patch on the other side: y becomes -y."""
        flip = np.array([1.0, -1.0, 1.0])
        return Patch((self.positions * flip)[:, ::-1], (self.normals * flip)[:, ::-1])

    def chosen(self, which: np.ndarray) -> Patch:
        """The triangles at which the mask `which` (n,) is true."""
        return Patch(self.positions[which], self.normals[which])


def merge(patches: Sequence[Patch]) -> Patch:
    """All triangles of `patches` in one."""
    return Patch(
        np.concatenate([patch.positions for patch in patches]),
        np.concatenate([patch.normals for patch in patches]),
    )


def rotation(axis: str, angle_rad: float) -> np.ndarray:
    """The 3x3 rotation about `x`, `y` or `z`, counter-clockwise seen against the axis."""
    cosine, sine = np.cos(angle_rad), np.sin(angle_rad)
    first, second = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    matrix = np.eye(3)
    matrix[first, first] = matrix[second, second] = cosine
    matrix[first, second], matrix[second, first] = -sine, sine
    return matrix


def shade(vertices: np.ndarray, faces: Faces, smooth_below_deg: float = SMOOTH_BELOW_DEG) -> Patch:
    """Triangles of convex polygon `faces` over `vertices` (n, 3), smooth up to an angle."""
    return shade_faces(vertices, faces, smooth_below_deg)[0]


def shade_faces(
    vertices: np.ndarray, faces: Faces, smooth_below_deg: float = SMOOTH_BELOW_DEG
) -> tuple[Patch, np.ndarray]:
    """As `shade`, and for each triangle the index of the face it came from."""
    vertices = np.asarray(vertices, dtype=float)
    fans = [(face[0], face[i], face[i + 1]) for face in faces for i in range(1, len(face) - 1)]
    origin = np.repeat(np.arange(len(faces)), [max(0, len(face) - 2) for face in faces])
    triangles = np.array(fans, dtype=np.int64)
    corners = vertices[triangles]
    crosses = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.linalg.norm(crosses, axis=1)
    kept = areas > 2.0 * SMALLEST_AREA_M2
    if not kept.any():
        return Patch(np.zeros((0, 3, 3)), np.zeros((0, 3, 3))), origin[kept]
    welded = _weld(vertices)[triangles[kept]]
    normals = _corner_normals(welded, crosses[kept], smooth_below_deg)
    return Patch(corners[kept], normals), origin[kept]


def _weld(vertices: np.ndarray) -> np.ndarray:
    """For each vertex the index of the first one in the same place (to a tenth of a millimetre)."""
    _, inverse = np.unique(np.round(vertices, 4), axis=0, return_inverse=True)
    return inverse.reshape(-1)


def _corner_normals(triangles: np.ndarray, crosses: np.ndarray, smooth_below_deg: float) -> np.ndarray:
    """Area-weighted means of the faces around each corner that bend less than the angle."""
    count = len(triangles)
    units = _unit(crosses)
    corner_vertex = triangles.ravel()
    corner_face = np.repeat(np.arange(count), 3)
    order = np.argsort(corner_vertex, kind="stable")
    sorted_vertex, sorted_face = corner_vertex[order], corner_face[order]
    start = np.searchsorted(sorted_vertex, corner_vertex, "left")
    end = np.searchsorted(sorted_vertex, corner_vertex, "right")
    shared = end - start
    corner = np.repeat(np.arange(3 * count), shared)
    first = np.cumsum(shared) - shared
    face = sorted_face[start[corner] + np.arange(len(corner)) - first[corner]]
    cosines = np.einsum("ij,ij->i", units[face], units[corner_face[corner]])
    near = cosines > np.cos(np.radians(smooth_below_deg))
    total = np.add.reduceat(np.where(near[:, None], crosses[face], 0.0), first, axis=0)
    flat = np.linalg.norm(total, axis=1, keepdims=True) < 1e-12
    return _unit(np.where(flat, units[corner_face], total)).reshape(count, 3, 3)


def _unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-12)


def grid_faces(rows: int, columns: int, wrap: bool = False) -> list[tuple[int, int, int, int]]:
    """Quads over vertices laid out row by row; `wrap` joins the last column to the first.

    Outside is (from column to column) x (from row to row).
    """
    steps = columns if wrap else columns - 1
    return [
        (
            row * columns + column,
            row * columns + (column + 1) % columns,
            (row + 1) * columns + (column + 1) % columns,
            (row + 1) * columns + column,
        )
        for row in range(rows - 1)
        for column in range(steps)
    ]


def loft(rings: np.ndarray, closed_ends: bool = True, smooth_below_deg: float = SMOOTH_BELOW_DEG) -> Patch:
    """A skin over closed rings (m, k, 3); each ring runs counter-clockwise seen from the last one."""
    count, size = rings.shape[:2]
    faces: list[Sequence[int]] = list(grid_faces(count, size, wrap=True))
    if closed_ends:
        faces.append(tuple(reversed(range(size))))
        faces.append(tuple(range((count - 1) * size, count * size)))
    return shade(rings.reshape(-1, 3), faces, smooth_below_deg)


def lathe(profile: Sequence[tuple[float, float]], segments: int, smooth_below_deg: float = 40.0) -> Patch:
    """A profile of (radius, height) turned about z; running upwards, its outside faces away from the axis."""
    angles = np.linspace(0.0, 2.0 * np.pi, segments, endpoint=False)
    circle = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    rows = [np.column_stack([circle * radius, np.full(segments, height)]) for radius, height in profile]
    return shade(np.concatenate(rows), grid_faces(len(profile), segments, wrap=True), smooth_below_deg)


def box(center: Sequence[float], size: Sequence[float], bevel: float = 0.0) -> Patch:
    """An axis-aligned box; `bevel` is the cut of its edges as a share of its shortest side (0 to 0.5)."""
    half = np.asarray(size, dtype=float) / 2.0
    if bevel <= 0.0:
        return shade(np.array(list(product((-1, 1), repeat=3))) * half + center, _BOX_FACES, 1.0)
    cut = bevel * 2.0 * half.min()
    signs, long_axis = _bevelled_topology()[:2]
    offsets = np.where(np.arange(3) == long_axis[:, None], half, half - cut)
    return shade(signs * offsets + center, _bevelled_topology()[2], 30.0)


_BOX_FACES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


@lru_cache(maxsize=1)
def _bevelled_topology() -> tuple[np.ndarray, np.ndarray, list[tuple[int, int, int]]]:
    """Signs, the axis at full reach, and triangles of a cube with cut edges."""
    signs = np.array([sign for sign in product((-1, 1), repeat=3) for _ in range(3)], dtype=float)
    axis = np.tile(np.arange(3), 8)
    points = signs * np.where(np.arange(3) == axis[:, None], 1.0, 0.7)
    hull = ConvexHull(points)
    faces = []
    for simplex, equation in zip(hull.simplices, hull.equations, strict=True):
        a, b, c = points[simplex]
        outward = np.cross(b - a, c - a) @ equation[:3] > 0
        faces.append(tuple(int(i) for i in (simplex if outward else simplex[::-1])))
    return signs, axis, faces


def ellipsoid(center: Sequence[float], radii: Sequence[float], segments: int = 12, rows: int = 7) -> Patch:
    """An ellipsoid with its axes along x, y and z."""
    angles = np.linspace(-np.pi / 2, np.pi / 2, rows + 1)
    ball = lathe([(float(np.cos(angle)), float(np.sin(angle))) for angle in angles], segments, 80.0)
    return ball.scaled(radii).moved(center)


def limb(
    start: Sequence[float], end: Sequence[float], start_radius: float, end_radius: float, segments: int = 8
) -> Patch:
    """A round-ended tapering tube between two points (m)."""
    start, end = np.asarray(start, dtype=float), np.asarray(end, dtype=float)
    length = max(float(np.linalg.norm(end - start)), 1e-6)
    lower = [(start_radius * np.sin(a), -start_radius * np.cos(a)) for a in (0.0, 0.6, 1.1)]
    upper = [(end_radius * np.sin(a), length + end_radius * np.cos(a)) for a in (1.1, 0.6, 0.0)]
    profile = [*lower, (start_radius, 0.0), (end_radius, length), *upper]
    return lathe(profile, segments, 80.0).turned(aligned(end - start)).moved(start)


def tube(start: Sequence[float], end: Sequence[float], radius: float, segments: int = 6) -> Patch:
    """A thin flat-ended rod between two points (m)."""
    start, end = np.asarray(start, dtype=float), np.asarray(end, dtype=float)
    length = float(np.linalg.norm(end - start))
    profile = [(0.0, 0.0), (radius, 0.0), (radius, length), (0.0, length)]
    return lathe(profile, segments, 70.0).turned(aligned(end - start)).moved(start)


def aligned(direction: np.ndarray) -> np.ndarray:
    """A rotation that takes z to `direction`."""
    z = direction / max(float(np.linalg.norm(direction)), 1e-12)
    guide = np.array([1.0, 0.0, 0.0]) if abs(z[0]) < 0.9 else np.array([0.0, 1.0, 0.0])
    y = np.cross(z, guide)
    y /= np.linalg.norm(y)
    return np.column_stack([np.cross(y, z), y, z])
