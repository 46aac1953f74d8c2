"""Cameras on a vehicle: where they sit, how they see, and `rig.toml`, which says so."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from .model import Camera

# Optical axes (x right, y down, z forward) in the axes of a level camera that looks along x (y left, z up).
_LEVEL_FROM_OPTICAL = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])


@dataclass(frozen=True)
class CameraMount:
    """One camera of a rig.

    `position_m` and `orientation_wxyz` take its optical frame into `base_link` (x forward, y left, z up,
    origin on the ground). `delay_s` is how long after the frame's moment it fires.
    """

    name: str
    width_px: int
    height_px: int
    fx: float
    fy: float
    cx: float
    cy: float
    position_m: tuple[float, float, float]
    orientation_wxyz: tuple[float, float, float, float]
    delay_s: float = 0.0

    def base_from_camera(self) -> np.ndarray:
        """Rigid 4x4 transform from the optical frame to `base_link`."""
        w, x, y, z = self.orientation_wxyz
        transform = np.eye(4)
        transform[:3, :3] = Rotation.from_quat([x, y, z, w]).as_matrix()
        transform[:3, 3] = self.position_m
        return transform

    def camera(self, world_from_base: np.ndarray) -> Camera:
        """The camera in the world, with the vehicle there."""
        pose = world_from_base @ self.base_from_camera()
        return Camera(self.width_px, self.height_px, self.fx, self.fy, self.cx, self.cy, pose)


def mount(
    name: str, size_px: tuple[int, int], focal_px: float, position_m: tuple[float, float, float], *,
    yaw_deg: float = 0.0, pitch_deg: float = 0.0, roll_deg: float = 0.0, delay_s: float = 0.0,
    center_px: tuple[float, float] | None = None,
) -> CameraMount:
    """A camera by its angles: yaw to the left, pitch downwards, roll clockwise as its picture sees it."""
    level = Rotation.from_euler("ZYX", [yaw_deg, pitch_deg, roll_deg], degrees=True).as_matrix()
    orientation = quaternion_wxyz(level @ _LEVEL_FROM_OPTICAL)
    cx, cy = center_px or (0.5 * size_px[0] - 0.5, 0.5 * size_px[1] - 0.5)
    return CameraMount(name, *size_px, focal_px, focal_px, cx, cy, position_m, orientation, delay_s)


def quaternion_wxyz(matrix: np.ndarray) -> tuple[float, float, float, float]:
    """The rotation as a unit quaternion with w not below 0, to nine digits."""
    x, y, z, w = Rotation.from_matrix(matrix).as_quat()
    sign = -1.0 if w < 0.0 else 1.0
    return tuple(round(float(sign * part), 9) + 0.0 for part in (w, x, y, z))


def rig_toml(cameras: Sequence[CameraMount]) -> str:
    """The text of `rig.toml`, without delays: the stamps of `frames.jsonl` say when each camera fired."""
    sections = ["# Poses: optical frame in base_link (x forward, y left, z up, origin on the ground).\n"]
    for camera in cameras:
        numbers = {"fx": camera.fx, "fy": camera.fy, "cx": camera.cx, "cy": camera.cy}
        lines = ["[[camera]]", f'name = "{camera.name}"']
        lines += [f"width = {camera.width_px}", f"height = {camera.height_px}"]
        lines += [f"{key} = {float(value)!r}" for key, value in numbers.items()]
        lines.append(f"position_m = {_floats(camera.position_m)}")
        lines.append(f"orientation_wxyz = {_floats(camera.orientation_wxyz)}")
        sections.append("\n".join(lines) + "\n")
    return "\n".join(sections)


def _floats(values: Sequence[float]) -> str:
    return "[" + ", ".join(repr(float(value)) for value in values) + "]"


def focal_for_view(width_px: int, view_deg: float) -> float:
    """The focal length (px) at which a picture of this width spans this horizontal angle."""
    return 0.5 * width_px / math.tan(math.radians(0.5 * view_deg))
