"""What of a scene a pass has to draw: instances with their buffers, left out where a view cannot see them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..model import Instance
from .buffers import BufferCache, ModelBuffers
from .projection import sphere_in_planes


@dataclass(frozen=True)
class Drawable:
    """An instance, its buffers, and its pose and bounding sphere in the world."""

    instance: Instance
    world_from_model: np.ndarray
    buffers: ModelBuffers
    center_m: np.ndarray
    radius_m: float


def drawables(instances: Sequence[Instance], cache: BufferCache) -> list[Drawable]:
    """All instances that have triangles, with buffers."""
    found = []
    for instance in instances:
        if len(instance.model.mesh.positions) == 0:
            continue
        buffers = cache.get(instance.model)
        pose = np.asarray(instance.world_from_model, dtype=float)
        center = pose[:3, :3] @ buffers.center_m + pose[:3, 3]
        found.append(Drawable(instance, pose, buffers, center, buffers.radius_m))
    return found


def seen(items: Sequence[Drawable], planes: np.ndarray) -> list[Drawable]:
    """The items whose sphere reaches into the planes."""
    return [item for item in items if sphere_in_planes(planes, item.center_m, item.radius_m)]


def nearest_first(items: Sequence[Drawable], eye_m: np.ndarray) -> list[Drawable]:
    """Small things from near to far, then what surrounds the eye: hidden pixels are then never shaded."""
    def key(item: Drawable) -> tuple[bool, float]:
        distance = float(np.linalg.norm(item.center_m - eye_m))
        return (distance < item.radius_m, distance - item.radius_m)

    return sorted(items, key=key)
