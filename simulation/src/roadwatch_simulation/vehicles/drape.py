"""Lays thin sheets (lamps, grilles, seams, windows) onto a curved shell, as seen from one side.

A sheet is drawn in the flat view from an azimuth: `across` runs from the viewer's left to the right (m),
`up` is z (m). Each of its points is then carried back along the line of sight onto the outermost triangle
there.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from roadwatch_simulation.geometry import Patch, grid_faces, shade

LIFT_M = 0.005
"""A sheet floats this far above the shell: enough for the depth buffer at 50 m, too little to be seen."""

LEAST_FACING = 0.06
"""Shell triangles seen at a flatter angle than this (cosine) take no sheet."""

Line = Sequence[tuple[float, float]]


class Drape:
    """A shell seen from `azimuth_deg` (0 from the front, 90 from the left), ready to carry sheets."""

    def __init__(self, shell: Patch, azimuth_deg: float) -> None:
        azimuth = np.radians(azimuth_deg)
        self.toward = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
        self.across = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
        corners = shell.positions
        faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        faces /= np.maximum(np.linalg.norm(faces, axis=1, keepdims=True), 1e-12)
        seen = faces @ self.toward > LEAST_FACING
        self._flat = np.stack([corners[seen] @ self.across, corners[seen][..., 2]], axis=-1)
        self._depth = corners[seen] @ self.toward
        self._normal = faces[seen]
        self._low, self._high = self._flat.min(axis=1), self._flat.max(axis=1)

    def point(self, position: Sequence[float]) -> tuple[float, float]:
        """Where a point in model axes stands in the flat view."""
        return float(np.dot(position, self.across)), float(position[2])

    def onto(self, points: np.ndarray, lift_m: float = LIFT_M) -> tuple[np.ndarray, np.ndarray]:
        """Points (n, 2) carried onto the shell: positions (n, 3), and which of them met it (n,)."""
        low, high = points.min(axis=0) - 1e-6, points.max(axis=0) + 1e-6
        near = np.all((self._high >= low) & (self._low <= high), axis=1)
        flat, depths, normals = self._flat[near], self._depth[near], self._normal[near]
        if len(flat) == 0:
            return np.zeros((len(points), 3)), np.zeros(len(points), dtype=bool)
        weights = _barycentric(points, flat)
        inside = weights.min(axis=2) >= -1e-6
        depth = np.where(inside, np.einsum("ptk,tk->pt", weights, depths), -np.inf)
        best = depth.argmax(axis=1)
        met = np.isfinite(depth.max(axis=1))
        reach = np.where(met, depth[np.arange(len(points)), best], 0.0)
        flat_part = points[:, :1] * self.across + points[:, 1:] * np.array([0.0, 0.0, 1.0])
        return flat_part + reach[:, None] * self.toward + normals[best] * lift_m, met

    def sheet(self, lower: Line, upper: Line, rows: int = 3, lift_m: float = LIFT_M) -> Patch:
        """A sheet between two lines of equally many points.

        `across` grows along both lines; `upper` lies above `lower`. Quads that miss the shell are left out.
        """
        shares = np.linspace(0.0, 1.0, rows)[:, None, None]
        points = np.asarray(lower, dtype=float) * (1.0 - shares) + np.asarray(upper, dtype=float) * shares
        count = points.shape[1]
        placed, met = self.onto(points.reshape(-1, 2), lift_m)
        faces = [face for face in grid_faces(rows, count) if met[list(face)].all()]
        if not faces:
            return Patch(np.zeros((0, 3, 3)), np.zeros((0, 3, 3)))
        return shade(placed, faces, 50.0)

    def rectangle(self, across: tuple[float, float], up: tuple[float, float], step_m: float = 0.06) -> Patch:
        """A rectangular sheet, fine enough to follow the shell."""
        columns = _steps(across[1] - across[0], step_m)
        line = np.linspace(across[0], across[1], columns)
        return self.sheet(
            [(x, up[0]) for x in line], [(x, up[1]) for x in line], _steps(up[1] - up[0], step_m)
        )

    def ellipse(
        self, center: tuple[float, float], radii: tuple[float, float], lift_m: float = LIFT_M, points: int = 8
    ) -> Patch:
        """An elliptic sheet."""
        angles = np.linspace(np.pi, 0.0, points)
        across = center[0] + radii[0] * np.cos(angles)
        rise = radii[1] * np.sin(angles)
        lower = list(zip(across, center[1] - rise, strict=True))
        upper = list(zip(across, center[1] + rise, strict=True))
        return self.sheet(lower, upper, 3, lift_m)

    def mound(
        self, foot: tuple[float, float], half_width: float, height: float, lift_m: float = LIFT_M
    ) -> Patch:
        """The upper half of an ellipse, standing with the middle of its flat side at `foot`."""
        angles = np.linspace(np.pi, 0.0, 8)
        across = foot[0] + half_width * np.cos(angles)
        upper = foot[1] + height * np.sin(angles)
        return self.sheet(
            [(x, foot[1]) for x in across], list(zip(across, upper, strict=True)), 3, lift_m
        )

    def stroke(self, line: Line, width_m: float, step_m: float = 0.09, lift_m: float = LIFT_M) -> Patch:
        """A thin band along a line, for seams, wipers and mouldings."""
        points = _resampled(np.asarray(line, dtype=float), step_m)
        tangents = np.gradient(points, axis=0)
        tangents /= np.maximum(np.linalg.norm(tangents, axis=1, keepdims=True), 1e-9)
        aside = np.stack([-tangents[:, 1], tangents[:, 0]], axis=1) * width_m / 2.0
        return self.sheet(points - aside, points + aside, 2, lift_m)


def _barycentric(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Weights (p, t, 3) of points (p, 2) in triangles (t, 3, 2)."""
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    area = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    area = np.where(np.abs(area) < 1e-12, 1e-12, area)
    offset = points[:, None] - a[None]
    second = (offset[..., 0] * (c - a)[:, 1] - offset[..., 1] * (c - a)[:, 0]) / area
    third = ((b - a)[:, 0] * offset[..., 1] - (b - a)[:, 1] * offset[..., 0]) / area
    return np.stack([1.0 - second - third, second, third], axis=-1)


def _steps(length_m: float, step_m: float) -> int:
    return max(2, int(np.ceil(abs(length_m) / step_m)) + 1)


def _resampled(line: np.ndarray, step_m: float) -> np.ndarray:
    lengths = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    at = np.linspace(0.0, lengths[-1], _steps(lengths[-1], step_m))
    return np.stack([np.interp(at, lengths, line[:, axis]) for axis in range(2)], axis=1)
