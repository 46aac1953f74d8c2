"""A bag of the daemon, exported and replayed: what Blender shows is what the bag says."""

from __future__ import annotations

import os
import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from daemon import DEMO, ONNX_RUNTIME, PROGRAM

FRAMES = 30
TOPIC = "/roadwatch/scene/objects"
MM = 0.001


@dataclass(frozen=True)
class BagScene:
    """A scene as the bag has it: its stamp, and where in base_link each object is, by its uuid's digits."""

    stamp_ns: int
    positions_m: dict[str, np.ndarray]


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """The demo's first frames as a bag, and the same exported as JSON lines."""
    folder = tmp_path_factory.mktemp("recorded")
    run("run", DEMO, "--pace", "lossless", "--frames", FRAMES, "--bag", folder / "bag")
    run("export", "scene", "--bag", folder / "bag", "-o", folder / "scene.jsonl")
    return folder


def run(*words) -> None:
    environment = {"ORT_DYLIB_PATH": str(ONNX_RUNTIME), **os.environ, "ROS_LOCALHOST_ONLY": "1"}
    done = subprocess.run(
        [PROGRAM, *map(str, words)], env=environment, capture_output=True, text=True, timeout=120
    )
    assert done.returncode == 0, done.stderr


def scenes_of_bag(bag: Path) -> list[BagScene]:
    """Read with the MCAP project's own packages: nothing of ours is in between."""
    from mcap.reader import make_reader
    from mcap_ros2.decoder import DecoderFactory

    scenes = []
    for file in sorted(bag.glob("*.mcap")):
        with file.open("rb") as stream:
            reader = make_reader(stream, decoder_factories=[DecoderFactory()])
            for *_, message in reader.iter_decoded_messages(topics=[TOPIC]):
                assert message.header.frame_id == "base_link"
                stamp = message.header.stamp
                positions_m = {bytes(each.uuid.uuid).hex(): xyz(each.position) for each in message.objects}
                scenes.append(BagScene(stamp.sec * 10**9 + stamp.nanosec, positions_m))
    return sorted(scenes, key=lambda scene: scene.stamp_ns)


def xyz(point) -> np.ndarray:
    return np.array([point.x, point.y, point.z])


def test_blender_shows_every_object_where_the_bag_has_it_to_a_millimetre(recorded):
    import bpy
    from roadwatch_viewer.reading import read_recording
    from roadwatch_viewer.replay import load_replay, set_time
    from roadwatch_viewer.settings import Settings

    bpy.ops.wm.read_factory_settings(use_empty=True)
    settings = Settings(range_m=10_000.0, most_objects=10_000)
    viewer = load_replay(bpy.context.scene, read_recording(recorded / "scene.jsonl"), settings)
    scenes = scenes_of_bag(recorded / "bag")
    assert len(scenes) == FRAMES and sum(len(scene.positions_m) for scene in scenes) > 5 * FRAMES
    worst_m = 0.0
    for scene in scenes:
        set_time(bpy.context.scene, (scene.stamp_ns - scenes[0].stamp_ns) * 1e-9, settings.fps)
        shown = {key: track for key, track in viewer.tracks.items() if is_shown(track)}
        assert shown.keys() == scene.positions_m.keys()
        base_from_world = viewer.vehicle.base_link.matrix_world.inverted()
        for key, position_m in scene.positions_m.items():
            in_base_m = np.array(base_from_world @ shown[key].root.matrix_world.translation)
            worst_m = max(worst_m, float(np.abs(in_base_m - position_m).max()))
    print(f"{len(scenes)} scenes, {len(viewer.tracks)} tracks, at most {worst_m * 1e3:.4f} mm apart")
    assert worst_m < MM


def is_shown(track) -> bool:
    return any(not each.hide_render for each in track.objects() if each.type == "MESH")
