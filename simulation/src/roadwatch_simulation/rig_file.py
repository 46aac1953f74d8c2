"""Cameras in a scene description: written out under `[[rig.camera]]`, or in a `rig.toml` that it names."""

from __future__ import annotations

import math
import re
import tomllib
from pathlib import Path
from typing import Any

from .rig import CameraMount, mount
from .table import Mistakes, Table

RIG_KEYS = ("file", "camera")
SIZE_KEYS = ("name", "width", "height", "fx", "fy", "cx", "cy", "position_m")
ANGLE_KEYS = ("yaw_deg", "pitch_deg", "roll_deg")
CAMERA_KEYS = (*SIZE_KEYS, "orientation_wxyz", *ANGLE_KEYS, "delay_s")
FILE_CAMERA_KEYS = (*SIZE_KEYS, "orientation_wxyz", "distortion_model", "distortion")
NAME = re.compile(r"(?!.*__)[A-Za-z][A-Za-z0-9_]*")
"""Names become ROS topics: no double underscore; `scene` is taken by the fused scene's topics."""
RESERVED_NAME = "scene"
MOST_SIDE_PX = 8192
UNIT_TOLERANCE = 1e-3


def read_mounts(scene: Table, folder: Path) -> tuple[CameraMount, ...]:
    """The cameras of a scene's `rig`; a rig file is looked for beside the scene."""
    mistakes = scene.mistakes
    if "rig" not in scene:
        mistakes.add("[rig]", "missing: a scene needs cameras, as [[rig.camera]] or with file = \"rig.toml\"")
        return ()
    rig = Table(scene.raw("rig"), "[rig]", mistakes, RIG_KEYS)
    if "file" in rig and "camera" in rig:
        rig.wrong("file", "give a file or cameras, not both")
        return ()
    if "file" in rig:
        return _from_file(rig, folder)
    return _cameras(rig.tables("camera"), "[[rig.camera]]", mistakes, CAMERA_KEYS)


def _from_file(rig: Table, folder: Path) -> tuple[CameraMount, ...]:
    name = rig.text("file")
    try:
        values = tomllib.loads((folder / name).read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        rig.wrong("file", f"cannot read `{name}`: {error}")
        return ()
    table = Table(values, name, rig.mistakes, ("camera",))
    return _cameras(table.tables("camera"), f"{name} [[camera]]", rig.mistakes, FILE_CAMERA_KEYS)


def _cameras(tables: list[Any], where: str, mistakes: Mistakes, known) -> tuple[CameraMount, ...]:
    if not tables:
        mistakes.add(where, "the rig has no cameras; it needs at least one")
    mounts = [
        _camera(Table(values, f"{where} {index}", mistakes, known))
        for index, values in enumerate(tables, start=1)
    ]
    names = [camera.name for camera in mounts]
    for index, name in enumerate(names):
        if name and name in names[:index]:
            first = names.index(name) + 1
            mistakes.add(f"{where} {index + 1} name", f"`{name}` is the name of camera {first} already")
    return tuple(mounts)


def _camera(table: Table) -> CameraMount:
    name = table.text("name")
    if name and (not NAME.fullmatch(name) or name == RESERVED_NAME):
        rule = "use letters, digits and single underscores, beginning with a letter; `scene` is taken"
        table.wrong("name", f"`{name}` cannot name a camera: {rule}")
    width, height = (table.integer(key, least=1, most=MOST_SIDE_PX) for key in ("width", "height"))
    fx = table.number("fx", least=1.0)
    fy = table.number("fy", fx, least=1.0)
    cx = table.number("cx", 0.5 * width - 0.5)
    cy = table.number("cy", 0.5 * height - 0.5)
    position = table.numbers("position_m", 3)
    if position is None:
        table.wrong("position_m", "missing: where the camera sits in base_link, metres")
    if table.raw("distortion_model") not in (None, "", "none"):
        table.wrong("distortion_model", "simulated cameras have no distortion")
    orientation = _orientation(table)
    delay = table.number("delay_s", 0.0, least=-10.0, most=10.0)
    return CameraMount(name, width, height, fx, fy, cx, cy, position or (0.0, 0.0, 1.5), orientation, delay)


def _orientation(table: Table) -> tuple[float, float, float, float]:
    """By quaternion, or by yaw (to the left), pitch (down) and roll of a camera that looks forward."""
    angles = [table.number(key, 0.0) for key in ANGLE_KEYS]
    by_angles = mount("", (2, 2), 1.0, (0, 0, 0), yaw_deg=angles[0], pitch_deg=angles[1], roll_deg=angles[2])
    if "orientation_wxyz" not in table:
        return by_angles.orientation_wxyz
    if any(key in table for key in ANGLE_KEYS):
        table.wrong("orientation_wxyz", "give a quaternion or angles, not both")
    quaternion = table.numbers("orientation_wxyz", 4)
    if quaternion is None:
        return by_angles.orientation_wxyz
    length = math.sqrt(sum(part * part for part in quaternion))
    if abs(length - 1.0) > UNIT_TOLERANCE:
        table.wrong("orientation_wxyz", f"its length is {length:.4f}; a rotation's is 1")
        return by_angles.orientation_wxyz
    return tuple(part / length for part in quaternion)
