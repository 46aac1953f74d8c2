"""Lines of the scene stream for tests: made by hand, and from the truth of a rig dataset."""

from __future__ import annotations

import json
import math
import tomllib
import uuid
from pathlib import Path

NO_MOTION = {"x": 0.0, "y": 0.0, "z": 0.0}


def xyz(values) -> dict:
    return dict(zip("xyz", (float(value) for value in values), strict=True))


def quaternion(xyzw) -> dict:
    return dict(zip("xyzw", (float(value) for value in xyzw), strict=True))


def yaw_quaternion(yaw_rad: float) -> tuple[float, float, float, float]:
    return (0.0, 0.0, math.sin(yaw_rad / 2.0), math.cos(yaw_rad / 2.0))


def stamp(time_ns: int) -> dict:
    return {"sec": time_ns // 10**9, "nanosec": time_ns % 10**9}


def track_uuid(track: int) -> dict:
    return {"uuid": list(uuid.uuid5(uuid.NAMESPACE_OID, f"track {track}").bytes)}


def an_object(
    track: int, position, *, size=(4.5, 1.8, 1.5), yaw=0.0, class_id="car", state="confirmed", score=0.9
) -> dict:
    """One object; `yaw` None is an unknown heading."""
    return {
        "track_id": track, "uuid": track_uuid(track), "state": state, "predicted": False, "age": 1.0,
        "class_id": class_id, "score": score, "box_px": [0.0, 0.0, 1.0, 1.0], "position": xyz(position),
        "size": xyz(size), "heading_known": yaw is not None, "yaw_rad": yaw or 0.0, "velocity": NO_MOTION,
        "components": [], "seen_by": ["front"],
    }  # fmt: skip


def a_scene(
    seq: int, time_ns: int, objects, *, frame="base_link", ego=(0.0, 0.0, 0.0), ego_yaw=0.0,
    motion="measured", ego_xyzw=None,
) -> dict:  # fmt: skip
    pose = {"position": xyz(ego), "orientation": quaternion(ego_xyzw or yaw_quaternion(ego_yaw))}
    header = {"stamp": stamp(time_ns), "frame_id": frame}
    scene = {"header": header, "camera": "", "ego_motion": motion, "ego_pose": pose, "objects": objects}
    return {"type": "scene", "seq": seq, "scene": scene}


def a_camera(name, size_px, k, position, xyzw) -> dict:
    described = {"header": {}, "width": size_px[0], "height": size_px[1], "distortion_model": "plumb_bob"}
    described |= {"d": [0.0] * 5, "k": [float(value) for value in k]}
    pose = {"translation": xyz(position), "rotation": quaternion(xyzw)}
    return {"name": name, "base_from_optical": pose, "camera_info": described}


def a_rig(cameras=(), version=1, base_frame="base_link") -> dict:
    return {
        "type": "rig", "schema": "roadwatch_scene", "version": version,
        "base_frame": base_frame, "cameras": list(cameras),
    }  # fmt: skip


FRONT = a_camera(
    "front", (960, 540), (700, 0, 470, 0, 690, 280, 0, 0, 1), (1.7, 0.1, 1.4), (-0.5, 0.5, -0.5, 0.5)
)


def text(lines) -> str:
    return "".join(json.dumps(line) + "\n" for line in lines)


def dataset_lines(folder: Path, camera: str | None = None) -> list[dict]:
    """A rig dataset's truth as the stream would say it; with `camera` what that one sees, at its moments.

    Without, each object is where the first camera that has it saw it: up to a frame's time off.
    """
    rig = tomllib.loads((folder / "rig.toml").read_text())
    frames = [json.loads(line) for line in (folder / "frames.jsonl").open()]
    seen: dict[int, dict[str, dict]] = {}
    for line in (folder / "truth.jsonl").open():
        truth = json.loads(line)
        if camera not in (None, truth["camera"]):
            continue
        for found in truth["objects"]:
            seen.setdefault(truth["frame"], {}).setdefault(found["id"], found)
    scenes = []
    for frame in frames:
        objects = [_truth_object(found) for found in seen.get(frame["frame"], {}).values()]
        w, x, y, z = frame["ego_orientation_world_wxyz"]
        time_ns = round((frame["stamp"][camera] if camera else frame["ego_stamp"]) * 1e6) * 1000
        ego = frame["ego_position_world_m"]
        scenes.append(a_scene(frame["frame"], time_ns, objects, ego=ego, ego_xyzw=(x, y, z, w)))
    return [a_rig(_toml_camera(each) for each in rig["camera"]), *scenes]


def _truth_object(found: dict) -> dict:
    return an_object(
        int(found["id"]), found["center_base_m"], size=found["size_lwh_m"], yaw=found["yaw_base_rad"],
        class_id=found["class"],
    )  # fmt: skip


def _toml_camera(camera: dict) -> dict:
    w, x, y, z = camera["orientation_wxyz"]
    k = (camera["fx"], 0, camera["cx"], 0, camera["fy"], camera["cy"], 0, 0, 1)
    return a_camera(
        camera["name"], (camera["width"], camera["height"]), k, camera["position_m"], (x, y, z, w)
    )
