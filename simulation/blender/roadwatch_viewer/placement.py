"""Where a scene's objects stand in odom, whatever frame the scene came in; all in double precision."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .pose import Pose, about_z, euler_xyz
from .schema import Scene, SceneObject

NOBODY_TELLS = "none"


@dataclass(frozen=True)
class Placed:
    """An object in odom: its box's centre (3,), its turn (roll, pitch, yaw), and how far it is (m, level)."""

    seen: SceneObject
    position_m: np.ndarray
    euler_rad: np.ndarray
    distance_m: float


@dataclass(frozen=True)
class PlacedScene:
    """A scene in odom; `odom_from_base` is where the vehicle stands."""

    seq: int
    stamp_ns: int
    odom_from_base: Pose
    objects: tuple[Placed, ...]


DEFAULT_BASE_FRAME = "base_link"


class Placement:
    """Places one scene after the other; remembers where the vehicle was while nobody tells."""

    def __init__(self, first_pose: Pose | None = None) -> None:
        """`first_pose` stands in for the vehicle's pose until one is known."""
        self.base_frame = DEFAULT_BASE_FRAME
        self._pose = first_pose or Pose.identity()

    def place(self, scene: Scene) -> PlacedScene:
        """The scene in odom. Without ego motion the vehicle stands where it last was."""
        has_pose = scene.ego_motion != NOBODY_TELLS
        if has_pose:
            self._pose = scene.ego_pose
        pose = self._pose
        count = len(scene.objects)
        points = np.array([seen.position_m for seen in scene.objects], dtype=float).reshape(count, 3)
        turns = about_z(np.array([seen.yaw_rad or 0.0 for seen in scene.objects], dtype=float))
        if scene.frame == self.base_frame or not has_pose:
            points, turns = pose.apply(points), pose.rotation @ turns
        level = (points - pose.position_m)[:, :2]
        distances, eulers = np.hypot(level[:, 0], level[:, 1]), euler_xyz(turns)
        rows = zip(scene.objects, points, eulers, distances, strict=True)
        placed = tuple(Placed(seen, point, euler, float(far)) for seen, point, euler, far in rows)
        return PlacedScene(scene.seq, scene.stamp_ns, pose, placed)


def first_known_pose(scenes: list[Scene]) -> Pose | None:
    """The pose of the first scene that has one: the world's origin of a replay."""
    return next((scene.ego_pose for scene in scenes if scene.ego_motion != NOBODY_TELLS), None)
