"""Truth of one picture: where every object is, what of it is seen, and where its parts are.

Boxes (`*_px` with four numbers) are edges: they run from 0 to the image's width and height. Positions
(`x_px`, `y_px`) count from pixel centres, as the camera's cx and cy do; an edge is a position plus 0.5.
"""

from __future__ import annotations

from collections.abc import Container, Sequence
from functools import lru_cache

import cv2
import numpy as np

from .model import Camera, Instance, Model, Rendered

# Cuboids are cut off here, in front of the camera: nothing nearer can be projected.
NEAR_M = 0.1
# A part counts as visible when its centre lies in the image and at least this share is seen of the pixels
# that its own outline would cover there.
PART_SEEN_SHARE = 0.3
PIXEL_DIGITS = 2
METRE_DIGITS = 4
RADIAN_DIGITS = 5
# Pairs of corners, in the order of `_cuboid_corners`, that an edge of the cuboid joins: one axis differs.
CUBOID_EDGES = tuple((first, first | axis) for axis in (1, 2, 4) for first in range(8) if not first & axis)
# Models live as long as their scene; more than this many at once is unusual.
CACHED_MODELS = 512

Box = tuple[float, float, float, float]


def object_truth(
    instances: Sequence[Instance],
    camera: Camera,
    rendered: Rendered,
    base_from_world: np.ndarray,
    moving_ids: Container[int] = frozenset(),
) -> list[dict]:
    """The objects of a line of truth.jsonl, in order of their distance from the camera.

    Objects without a single pixel in the image, even with nothing in front of them, are left out; those
    that are wholly hidden stay, with `occluded` 1. `stationary` is false for the ids in `moving_ids`.
    """
    objects = []
    for instance in instances:
        object_id = instance.object_id
        if object_id > 0 and instance.model.object_class and object_id in rendered.silhouettes_px:
            stationary = object_id not in moving_ids
            objects.append(_one_object(instance, camera, rendered, base_from_world, stationary))
    return sorted(objects, key=lambda found: float(np.linalg.norm(found["center_camera_m"])))


def _one_object(
    instance: Instance, camera: Camera, rendered: Rendered, base_from_world: np.ndarray, stationary: bool
) -> dict:
    box, truncated = cuboid_box(instance, camera)
    silhouette_count, silhouette_box = rendered.silhouettes_px[instance.object_id]
    parts_seen = _window(rendered, instance.object_id, silhouette_box)
    visible_count = int(np.count_nonzero(parts_seen >= 0))
    return {
        "id": str(instance.object_id),
        "class": instance.model.object_class,
        "label": instance.model.label,
        "box_px": _rounded(box, PIXEL_DIGITS),
        "truncated": round(truncated, 3),
        "occluded": round(1.0 - visible_count / silhouette_count, 3),
        **_placement(instance, camera, base_from_world),
        "stationary": stationary,
        "silhouette_px": _rounded(silhouette_box, PIXEL_DIGITS),
        "visible_px": _mask_box(parts_seen >= 0, silhouette_box),
        "parts": _parts(instance, camera, parts_seen, silhouette_box),
    }


def _placement(instance: Instance, camera: Camera, base_from_world: np.ndarray) -> dict:
    height_m = instance.model.size_lwh_m[2]
    center_world = instance.world_from_model @ np.array([0.0, 0.0, height_m / 2.0, 1.0])
    forward_world = instance.world_from_model[:3, 0]
    camera_from_world = np.linalg.inv(camera.world_from_camera)
    forward_camera = camera_from_world[:3, :3] @ forward_world
    forward_base = base_from_world[:3, :3] @ forward_world
    return {
        "center_camera_m": _rounded((camera_from_world @ center_world)[:3], METRE_DIGITS),
        "center_base_m": _rounded((base_from_world @ center_world)[:3], METRE_DIGITS),
        "size_lwh_m": _rounded(instance.model.size_lwh_m, METRE_DIGITS),
        "yaw_base_rad": round(float(np.arctan2(forward_base[1], forward_base[0])), RADIAN_DIGITS),
        "rotation_y_rad": round(float(np.arctan2(-forward_camera[2], forward_camera[0])), RADIAN_DIGITS),
    }


def cuboid_box(instance: Instance, camera: Camera) -> tuple[Box, float]:
    """The box of the projected cuboid's hull, clipped to the image, and the truncated share.

    The share is that of the box's own area outside the image, 0 to 1; what lies behind the camera is cut
    off first. A cuboid wholly behind the camera has an empty box and is truncated by 1.
    """
    points = _in_front(_cuboid_corners(instance), camera)
    if len(points) == 0:
        return (0.0, 0.0, 0.0, 0.0), 1.0
    edges = camera.project(points)[:, :2] + 0.5
    low, high = edges.min(axis=0), edges.max(axis=0)
    size = np.array([camera.width_px, camera.height_px], dtype=float)
    inner_low, inner_high = np.clip(low, 0.0, size), np.clip(high, 0.0, size)
    share_inside = np.prod(inner_high - inner_low) / max(np.prod(high - low), 1e-9)
    return (*map(float, inner_low), *map(float, inner_high)), float(np.clip(1.0 - share_inside, 0.0, 1.0))


def _cuboid_corners(instance: Instance) -> np.ndarray:
    length, width, height = instance.model.size_lwh_m
    signs = (-0.5, 0.5)
    heights = (0.0, height)
    local = np.array([(length * x, width * y, z, 1.0) for x in signs for y in signs for z in heights])
    return (local @ np.asarray(instance.world_from_model, dtype=float).T)[:, :3]


def _in_front(corners: np.ndarray, camera: Camera) -> np.ndarray:
    """Corners in front of the near plane, and where edges of the cuboid cross it."""
    depth = camera.project(corners)[:, 2]
    points = [corners[depth >= NEAR_M]]
    for first, second in CUBOID_EDGES:
        if (depth[first] >= NEAR_M) != (depth[second] >= NEAR_M):
            share = (NEAR_M - depth[first]) / (depth[second] - depth[first])
            points.append((corners[first] + share * (corners[second] - corners[first]))[None])
    return np.concatenate(points)


def _window(rendered: Rendered, object_id: int, box: Box) -> np.ndarray:
    """Part ids within the box where the object itself is seen, -1 elsewhere."""
    left, top, right, bottom = (int(edge) for edge in box)
    owned = rendered.object_ids[top:bottom, left:right] == object_id
    return np.where(owned, rendered.part_ids[top:bottom, left:right].astype(np.int16), -1)


def _mask_box(mask: np.ndarray, box: Box) -> list[float] | None:
    """The box of a mask's true pixels; the mask's own corner lies at the box's."""
    columns, rows = np.flatnonzero(mask.any(axis=0)), np.flatnonzero(mask.any(axis=1))
    if len(columns) == 0:
        return None
    left, top = box[0], box[1]
    right, bottom = left + float(columns[-1] + 1), top + float(rows[-1] + 1)
    return [left + float(columns[0]), top + float(rows[0]), right, bottom]


def _parts(instance: Instance, camera: Camera, parts_seen: np.ndarray, silhouette_box: Box) -> list[dict]:
    found = []
    outlines = _part_points(instance.model)
    for index, (name, center) in enumerate(instance.model.part_centers_m.items(), start=1):
        x, y, depth = camera.project(_to_world(instance, np.array([center])))[0]
        if depth < NEAR_M:
            continue
        inside = -0.5 <= x < camera.width_px - 0.5 and -0.5 <= y < camera.height_px - 0.5
        mask = parts_seen == index
        own_px = _outline_area_px(_to_world(instance, outlines[index]), camera) if index in outlines else 0.0
        found.append(
            {
                "name": name,
                "x_px": round(float(x), PIXEL_DIGITS),
                "y_px": round(float(y), PIXEL_DIGITS),
                "visible": bool(inside and mask.any() and np.count_nonzero(mask) >= PART_SEEN_SHARE * own_px),
                "box_px": _mask_box(mask, silhouette_box),
            }
        )
    return found


def _to_world(instance: Instance, points_m: np.ndarray) -> np.ndarray:
    pose = np.asarray(instance.world_from_model, dtype=float)
    return points_m @ pose[:3, :3].T + pose[:3, 3]


class _ByIdentity:
    """A key for a cache: the model itself, compared by identity and kept alive by the cache."""

    def __init__(self, model: Model) -> None:
        self.model = model

    def __hash__(self) -> int:
        return id(self.model)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _ByIdentity) and other.model is self.model


def _part_points(model: Model) -> dict[int, np.ndarray]:
    """Vertices (n, 3) of each part, by the part's number."""
    return _part_points_of(_ByIdentity(model))


@lru_cache(maxsize=CACHED_MODELS)
def _part_points_of(key: _ByIdentity) -> dict[int, np.ndarray]:
    mesh = key.model.mesh
    numbers = [int(number) for number in np.unique(mesh.parts) if number > 0]
    corners = {number: mesh.positions[mesh.parts == number].reshape(-1, 3) for number in numbers}
    return {number: np.unique(points, axis=0).astype(float) for number, points in corners.items()}


def _outline_area_px(points_world_m: np.ndarray, camera: Camera) -> float:
    """Pixels within the image that the convex outline of the points covers; 0 when it reaches the camera."""
    projected = camera.project(points_world_m)
    if projected[:, 2].min() < NEAR_M:
        return 0.0
    hull = cv2.convexHull((projected[:, :2] + 0.5).astype(np.float32))
    right, bottom = float(camera.width_px), float(camera.height_px)
    image = np.array([(0, 0), (right, 0), (right, bottom), (0, bottom)], dtype=np.float32)
    area, _ = cv2.intersectConvexConvex(hull, image)
    return float(area)


def _rounded(values: Sequence[float] | np.ndarray, digits: int) -> list[float]:
    return [round(float(value), digits) for value in values]
