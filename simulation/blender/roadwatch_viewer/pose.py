"""Rigid transforms in double precision: Blender holds single, which is 0.5 m coarse at UTM coordinates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class Pose:
    """`a_from_b`: takes points of b to a. `position_m` is (3,), `rotation` (3, 3), float64."""

    position_m: np.ndarray
    rotation: np.ndarray

    @staticmethod
    def identity() -> Pose:
        return Pose(np.zeros(3), np.eye(3))

    @staticmethod
    def from_quaternion(position_m: tuple[float, ...], xyzw: tuple[float, float, float, float]) -> Pose:
        """Raises ValueError for a quaternion that is far from unit length."""
        length = float(np.sqrt(sum(part * part for part in xyzw)))
        if not 0.9 < length < 1.1:
            raise ValueError(f"a rotation of length {length:g}, not 1")
        x, y, z, w = (part / length for part in xyzw)
        rotation = np.array([
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ])  # fmt: skip
        return Pose(np.array(position_m, dtype=float), rotation)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Pose):
            return NotImplemented
        same_place = np.array_equal(self.position_m, other.position_m)
        return same_place and np.array_equal(self.rotation, other.rotation)

    def apply(self, points_m: np.ndarray) -> np.ndarray:
        """Points (n, 3) of b, in a."""
        return points_m @ self.rotation.T + self.position_m

    def inverse(self) -> Pose:
        """`b_from_a`."""
        return Pose(-self.rotation.T @ self.position_m, self.rotation.T)


def about_z(yaws_rad: np.ndarray) -> np.ndarray:
    """Rotations (n, 3, 3) about z, counter-clockwise."""
    turns = np.zeros((len(yaws_rad), 3, 3))
    cosines, sines = np.cos(yaws_rad), np.sin(yaws_rad)
    turns[:, 0, 0], turns[:, 0, 1] = cosines, -sines
    turns[:, 1, 0], turns[:, 1, 1] = sines, cosines
    turns[:, 2, 2] = 1.0
    return turns


def euler_xyz(rotations: np.ndarray) -> np.ndarray:
    """Roll, pitch and yaw (n, 3), radians, as Blender's XYZ order has them: Rz(yaw) Ry(pitch) Rx(roll)."""
    roll = np.arctan2(rotations[:, 2, 1], rotations[:, 2, 2])
    pitch = -np.arcsin(np.clip(rotations[:, 2, 0], -1.0, 1.0))
    yaw = np.arctan2(rotations[:, 1, 0], rotations[:, 0, 0])
    return np.stack([roll, pitch, yaw], axis=1)
