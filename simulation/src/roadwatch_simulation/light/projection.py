"""Matrices of the passes: the camera's projection, what it can see, and the sun's view of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..model import Camera

NEAR_M = 0.1
FAR_M = 1500.0


def clip_from_camera(camera: Camera) -> np.ndarray:
    """OpenGL's projection for optical axes; row 0 of the buffer is the top row of the image.

    The middle of the first pixel is (0, 0), so edges of the image lie at -0.5 and width - 0.5.
    """
    matrix = np.zeros((4, 4))
    matrix[0, 0] = 2.0 * camera.fx / camera.width_px
    matrix[0, 2] = 2.0 * (camera.cx + 0.5) / camera.width_px - 1.0
    matrix[1, 1] = 2.0 * camera.fy / camera.height_px
    matrix[1, 2] = 2.0 * (camera.cy + 0.5) / camera.height_px - 1.0
    matrix[2, 2] = (FAR_M + NEAR_M) / (FAR_M - NEAR_M)
    matrix[2, 3] = -2.0 * FAR_M * NEAR_M / (FAR_M - NEAR_M)
    matrix[3, 2] = 1.0
    return matrix


def clip_from_world(camera: Camera) -> np.ndarray:
    """The whole way from world to clip coordinates."""
    return clip_from_camera(camera) @ np.linalg.inv(camera.world_from_camera)


def frustum_planes(clip_from_world_matrix: np.ndarray) -> np.ndarray:
    """Planes (5, 4) of a clip volume without its far side, unit normals inward: n . p + d >= 0 inside."""
    rows = clip_from_world_matrix
    sides = [rows[3] + rows[0], rows[3] - rows[0], rows[3] + rows[1], rows[3] - rows[1]]
    planes = np.stack([*sides, rows[3] + rows[2]])
    return planes / np.linalg.norm(planes[:, :3], axis=1, keepdims=True)


def sphere_in_planes(planes: np.ndarray, center_m: np.ndarray, radius_m: float) -> bool:
    """False only when the sphere lies wholly outside one of the planes."""
    return bool(np.all(planes[:, :3] @ center_m + planes[:, 3] >= -radius_m))


def matrix_bytes(matrix: np.ndarray) -> bytes:
    """A matrix as OpenGL wants it: columns first, float32."""
    return np.ascontiguousarray(matrix.T, dtype=np.float32).tobytes()


@dataclass(frozen=True)
class Cascade:
    """A part of the camera's view, in depth, with a shadow map of its own."""

    near_m: float
    far_m: float
    top_m: float


# Near enough for crisp wheels and mirrors, then far enough that parked rows keep their shadows.
CASCADES = (Cascade(NEAR_M, 18.0, 4.0), Cascade(18.0, 90.0, 16.0))
# Casters this far up the sun's ray still throw a shadow into the view.
CASTER_REACH_M = 150.0
GROUND_MARGIN_M = 0.5


def _footprint_corners(camera: Camera, cascade: Cascade, ground_z_m: float) -> np.ndarray:
    edges_x = (np.array([-0.5, camera.width_px - 0.5]) - camera.cx) / camera.fx
    edges_y = (np.array([-0.5, camera.height_px - 0.5]) - camera.cy) / camera.fy
    rays = np.array([(x, y, 1.0) for x in edges_x for y in edges_y])
    points = np.concatenate([rays * cascade.near_m, rays * cascade.far_m])
    world = points @ camera.world_from_camera[:3, :3].T + camera.world_from_camera[:3, 3]
    heights = (ground_z_m - GROUND_MARGIN_M, ground_z_m + cascade.top_m)
    return np.array([(x, y, z) for x, y, _ in world for z in heights])


def _sun_axes(sun_direction: np.ndarray) -> np.ndarray:
    """Rotation from world to the sun's axes; the third axis points away from the sun."""
    forward = -sun_direction / np.linalg.norm(sun_direction)
    helper = np.array([0.0, 0.0, 1.0]) if abs(forward[2]) < 0.95 else np.array([1.0, 0.0, 0.0])
    right = np.cross(forward, helper)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(right, forward), forward])


def shadow_clip_from_world(
    camera: Camera, cascade: Cascade, sun_direction: np.ndarray, ground_z_m: float
) -> np.ndarray:
    """A parallel projection along the sun that just holds what the cascade sees near the ground."""
    axes = _sun_axes(np.asarray(sun_direction, dtype=float))
    corners = _footprint_corners(camera, cascade, ground_z_m) @ axes.T
    low, high = corners.min(axis=0), corners.max(axis=0)
    low[2] -= CASTER_REACH_M
    scale = 2.0 / (high - low)
    matrix = np.eye(4)
    matrix[:3, :3] = axes * scale[:, None]
    matrix[:3, 3] = -(high + low) / (high - low)
    return matrix
