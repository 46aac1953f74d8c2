"""The lines of docs/scene-stream.md as values: checked once, here."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from typing import Any

from .errors import MalformedLine, NewerVersion
from .pose import Pose

SCHEMA = "roadwatch_scene"
KNOWN_VERSION = 1
NS_PER_S = 1_000_000_000


@dataclass(frozen=True)
class RigCamera:
    """A camera of the rig; `cx` and `cy` count from pixel centres, as ROS has it."""

    name: str
    width_px: int
    height_px: int
    fx: float
    fy: float
    cx: float
    cy: float
    has_distortion: bool
    base_from_optical: Pose


@dataclass(frozen=True)
class Rig:
    """The first line; scenes in any frame but `base_frame` are in odom."""

    base_frame: str
    cameras: tuple[RigCamera, ...]


@dataclass(frozen=True)
class SceneObject:
    """One object: `position_m` is the centre of its box in the scene's frame; `yaw_rad` None when unknown.

    `key` tells tracks apart: the uuid's digits, or the track id with the camera's name without tracking.
    """

    key: str
    track_id: int
    class_id: str
    state: str
    score: float
    position_m: tuple[float, float, float]
    size_lwh_m: tuple[float, float, float]
    yaw_rad: float | None


@dataclass(frozen=True)
class Scene:
    """One scene: positions are in `frame`, the rig's or else odom; `ego_pose` is odom_from_base."""

    seq: int
    stamp_ns: int
    frame: str
    ego_motion: str
    ego_pose: Pose
    objects: tuple[SceneObject, ...]


def parse_line(text: str | bytes) -> Rig | Scene | None:
    """What a line says; None for a type of line that is not known.

    Raises MalformedLine, and NewerVersion for a rig line of a newer schema.
    """
    try:
        line = json.loads(text, parse_constant=_refuse_constant)
    except (ValueError, RecursionError) as error:
        raise MalformedLine(f"no JSON: {error}") from None
    if not isinstance(line, dict) or not isinstance(line.get("type"), str):
        raise MalformedLine('no object with a "type"')
    try:
        if line["type"] == "rig":
            return _rig(line)
        if line["type"] == "scene":
            return _scene(line)
    except (KeyError, TypeError, ValueError, IndexError, AttributeError, OverflowError) as error:
        what = f"no key {error}" if isinstance(error, KeyError) else str(error)
        raise MalformedLine(f"{line['type']} line: {what}") from None
    return None


def _refuse_constant(name: str) -> float:
    raise ValueError(f"{name} is no number of this schema")


def _rig(line: dict[str, Any]) -> Rig:
    if line["schema"] != SCHEMA:
        raise MalformedLine(f"schema {line['schema']!r}, not {SCHEMA!r}")
    version = _whole(line["version"])
    if version > KNOWN_VERSION:
        raise NewerVersion(
            f"the stream is {SCHEMA} version {version}, and this viewer knows none above {KNOWN_VERSION}: "
            "install the viewer that came with this daemon"
        )
    return Rig(_text(line["base_frame"]), tuple(_camera(camera) for camera in line["cameras"]))


def _camera(camera: dict[str, Any]) -> RigCamera:
    described = camera["camera_info"]
    k = described["k"]
    width_px, height_px = _whole(described["width"]), _whole(described["height"])
    fx, fy = _number(k[0]), _number(k[4])
    if min(width_px, height_px) < 1 or min(fx, fy) <= 0.0:
        raise ValueError(f"camera {camera['name']!r} has a size or focal length that is not above 0")
    has_distortion = any(_number(value) != 0.0 for value in described.get("d", ()))
    pose = _pose(camera["base_from_optical"], "translation", "rotation")
    return RigCamera(
        _text(camera["name"]), width_px, height_px, fx, fy, _number(k[2]), _number(k[5]), has_distortion, pose
    )


def _scene(line: dict[str, Any]) -> Scene:
    scene = line["scene"]
    header = scene["header"]
    return Scene(
        seq=_whole(line["seq"]),
        stamp_ns=_stamp_ns(header["stamp"]),
        frame=_text(header["frame_id"]),
        ego_motion=_text(scene["ego_motion"]),
        ego_pose=_pose(scene["ego_pose"], "position", "orientation"),
        objects=tuple(_object(found) for found in scene["objects"]),
    )


def _object(found: dict[str, Any]) -> SceneObject:
    track_id = _whole(found["track_id"])
    size = found["size"]
    return SceneObject(
        key=_key(found, track_id),
        track_id=track_id,
        class_id=_text(found["class_id"]),
        state=_text(found["state"]),
        score=_number(found["score"]),
        position_m=_xyz(found["position"]),
        size_lwh_m=_xyz(size),
        yaw_rad=_number(found["yaw_rad"]) if _truth(found["heading_known"]) else None,
    )


def _key(found: dict[str, Any], track_id: int) -> str:
    digits = bytes(found["uuid"]["uuid"])
    if len(digits) != 16:
        raise ValueError(f"a uuid of {len(digits)} bytes")
    if any(digits):
        return digits.hex()
    return f"{'+'.join(found['seen_by'])}:{track_id}"


def _pose(pose: dict[str, Any], position: str, orientation: str) -> Pose:
    turn = pose[orientation]
    xyzw = (_number(turn["x"]), _number(turn["y"]), _number(turn["z"]), _number(turn["w"]))
    return Pose.from_quaternion(_xyz(pose[position]), xyzw)


def _stamp_ns(stamp: dict[str, Any]) -> int:
    return _whole(stamp["sec"]) * NS_PER_S + _whole(stamp["nanosec"])


def _xyz(vector: dict[str, Any]) -> tuple[float, float, float]:
    return _number(vector["x"]), _number(vector["y"]), _number(vector["z"])


def _number(value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        raise ValueError(f"{value!r} is no finite number")
    return float(value)


def _whole(value: Any) -> int:
    if isinstance(value, bool) or not isinstance(value, int):
        raise ValueError(f"{value!r} is no whole number")
    return value


def _text(value: Any) -> str:
    if not isinstance(value, str):
        raise ValueError(f"{value!r} is no text")
    return value


def _truth(value: Any) -> bool:
    if not isinstance(value, bool):
        raise ValueError(f"{value!r} is neither true nor false")
    return value
