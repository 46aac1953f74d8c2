"""Finds things of a scene that stand inside one another, or around a camera."""

from __future__ import annotations

import math

import numpy as np

from .scene import Scene
from .scenery import Footprint

MOST_REPORTED = 20
CAMERA_CLEARANCE_M = 0.3


def collisions(scene: Scene) -> list[str]:
    """One message for each pair that overlaps, with the first frame at which it does."""
    moving = [thing.path.is_moving for thing in scene.objects]
    found: dict[tuple[int, int], str] = {}
    for frame in range(scene.frames):
        prints = [thing.footprint(scene.time_s(frame)) for thing in scene.objects]
        for first, second in _near_pairs(prints):
            if (first, second) in found or (frame > 0 and not moving[first] and not moving[second]):
                continue
            if prints[first].overlaps(prints[second]):
                found[first, second] = _message(scene, first, second, frame, prints)
        _check_cameras(scene, frame, prints, found)
        if len(found) >= MOST_REPORTED:
            break
    return list(found.values())[:MOST_REPORTED]


def _near_pairs(prints: list[Footprint]) -> list[tuple[int, int]]:
    """Pairs whose circles meet."""
    if len(prints) < 2:
        return []
    middle = np.array([(each.x_m, each.y_m) for each in prints])
    radius = np.array([0.5 * math.hypot(each.length_m, each.width_m) for each in prints])
    apart = np.linalg.norm(middle[:, None] - middle[None], axis=2)
    first, second = np.nonzero(np.triu(apart < radius[:, None] + radius[None], 1))
    return list(zip(first.tolist(), second.tolist(), strict=True))


def _message(scene: Scene, first: int, second: int, frame: int, prints: list[Footprint]) -> str:
    at = prints[second]
    names = [f"[[object]] {index + 1} ({scene.objects[index].name})" for index in (first, second)]
    place = f"x {at.x_m:.1f} y {at.y_m:.1f} m"
    return f"{names[0]} and {names[1]} stand inside each other at frame {frame}, near {place}"


def _check_cameras(
    scene: Scene, frame: int, prints: list[Footprint], found: dict[tuple[int, int], str]
) -> None:
    for number, mount in enumerate(scene.cameras):
        x, y, z = scene.camera_at(frame, mount).world_from_camera[:3, 3]
        lens = Footprint(float(x), float(y), 0.0, CAMERA_CLEARANCE_M, CAMERA_CLEARANCE_M)
        for index, each in enumerate(prints):
            key = (-1 - number, index)
            height = scene.objects[index].model.size_lwh_m[2]
            if key not in found and z < height + CAMERA_CLEARANCE_M and lens.overlaps(each):
                thing = f"[[object]] {index + 1} ({scene.objects[index].name})"
                found[key] = f"{thing} stands around camera `{mount.name}` at frame {frame}"
