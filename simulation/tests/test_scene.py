"""Scene descriptions: what they mean at every frame, and how mistakes in them are told."""

from __future__ import annotations

import json
import math
import tomllib
from pathlib import Path

import numpy as np
import pytest

from roadwatch_simulation.errors import SimulationError
from roadwatch_simulation.motion import Path as MotionPath
from roadwatch_simulation.motion import Waypoint, standing
from roadwatch_simulation.rig import mount, rig_toml
from roadwatch_simulation.scene_file import read_scene

EXAMPLES = Path(__file__).parents[1] / "scenes"
CAMERA = """
[[rig.camera]]
name = "front"
width = 160
height = 90
fx = 120.0
position_m = [0.0, 0.0, 1.5]
"""
HEAD = 'frames = 3\n[environment]\nkind = "plain"\n' + CAMERA


def read(folder: Path, text: str):
    file = folder / "scene.toml"
    file.write_text(text)
    return read_scene(file)


def mistakes(folder: Path, text: str) -> list[str]:
    with pytest.raises(SimulationError) as caught:
        read(folder, text)
    return str(caught.value).splitlines()


def test_example_scenes_are_sound():
    files = [file for file in sorted(EXAMPLES.glob("*.toml")) if file.name != "rig.toml"]
    assert len(files) >= 2
    for file in files:
        assert read_scene(file).objects


def test_unknown_keys_are_refused_with_their_place(tmp_path):
    found = mistakes(tmp_path, HEAD.replace('kind = "plain"', 'kind = "plain"\nweather = "rain"'))
    assert found == [
        "scene.toml: [environment] weather: unknown key; "
        "known: kind, seed, light, sun_azimuth_deg, sun_elevation_deg"
    ]


def test_all_mistakes_are_reported_together(tmp_path):
    text = HEAD.replace("frames = 3", "frames = 0").replace('"plain"',
        '"beach"') + '[[object]]\nkind = "tank"\n'
    found = "\n".join(mistakes(tmp_path, text))
    for part in ("frames: is 0", "`beach` does not exist", "[[object]] 1 kind: `tank` does not exist",
        "`waypoints`"):
        assert part in found


def test_a_rig_without_cameras_is_refused(tmp_path):
    assert "a scene needs cameras" in mistakes(tmp_path, "frames = 1\n")[0]
    assert "no cameras" in mistakes(tmp_path, "frames = 1\n[rig]\ncamera = []\n")[0]


def test_camera_names_are_unique(tmp_path):
    assert mistakes(tmp_path,
        HEAD + CAMERA) == ["scene.toml: [[rig.camera]] 2 name: `front` is the name of camera 1 already"]


@pytest.mark.parametrize("name", ["scene", "a__b", "1st", "left-front"])
def test_camera_names_that_cannot_be_topics_are_refused(tmp_path, name):
    assert "cannot name a camera" in mistakes(tmp_path, HEAD.replace('"front"', f'"{name}"'))[0]


def test_a_car_inside_another_is_refused_with_both_names_and_the_frame(tmp_path):
    still = '[[object]]\nname = "parked"\nkind = "sedan"\nx_m = 20.0\ny_m = 0.0\nyaw_deg = 30.0\n'
    mover = (
        '[[object]]\nname = "mover"\nkind = "suv"\nwaypoints = [{time_s = 0.0, x_m = 20.0, y_m = 12.0}, '
        "{time_s = 0.2, x_m = 20.0, y_m = 0.0}]\n"
    )
    found = mistakes(tmp_path, HEAD + still + mover)
    assert len(found) == 1
    for part in ("1 (parked)", "2 (mover)", "frame 2"):
        assert part in found[0]


def test_cars_side_by_side_are_not_inside_each_other(tmp_path):
    cars = "".join(f'[[object]]\nkind = "sedan"\nx_m = 20.0\ny_m = {y}\n' for y in (0.0, 2.3, -2.3))
    assert len(read(tmp_path, HEAD + cars).objects) == 3


def test_a_car_around_a_camera_is_refused(tmp_path):
    found = mistakes(tmp_path, HEAD + '[[object]]\nkind = "bus"\nx_m = 0.0\ny_m = 0.0\n')
    assert "stands around camera `front`" in found[0]


def test_json_has_the_same_keys(tmp_path):
    text = HEAD + '[[object]]\nkind = "sedan"\nx_m = 20.0\ny_m = 1.0\n'
    (tmp_path / "scene.json").write_text(json.dumps(tomllib.loads(text)))
    from_toml, from_json = read(tmp_path, text), read_scene(tmp_path / "scene.json")
    assert from_toml.objects[0].path == from_json.objects[0].path
    assert from_toml.cameras == from_json.cameras


def test_a_file_that_is_no_toml_names_the_file(tmp_path):
    assert mistakes(tmp_path, "frames = \n")[0].startswith("scene.toml: ")


def test_a_rig_file_is_read_beside_the_scene(tmp_path):
    cameras = (mount("left", (64, 48), 50.0, (0.0, 0.5, 1.5), yaw_deg=90.0),)
    (tmp_path / "rig.toml").write_text(rig_toml(cameras))
    scene = read(tmp_path, 'frames = 1\n[environment]\nkind = "plain"\n[rig]\nfile = "rig.toml"\n')
    np.testing.assert_allclose(scene.cameras[0].base_from_camera(), cameras[0].base_from_camera(), atol=1e-8)


def test_a_camera_looks_where_its_angles_say():
    left_and_down = mount("a", (64, 48), 50.0, (0, 0, 0), yaw_deg=90.0, pitch_deg=10.0).base_from_camera()
    np.testing.assert_allclose(left_and_down[:3, 2],
        [0.0, math.cos(math.radians(10)), -math.sin(math.radians(10))], atol=1e-8)
    level = mount("b", (64, 48), 50.0, (0, 0, 0)).base_from_camera()
    np.testing.assert_allclose(level[:3, :3], [[0, 0, 1], [-1, 0, 0], [0, -1, 0]], atol=1e-8)


def test_cameras_see_the_world_at_their_own_moment(tmp_path):
    text = HEAD.replace("fx = 120.0", "fx = 120.0\ndelay_s = 0.05") + (
        '[[object]]\nkind = "sedan"\nwaypoints = [{time_s = 0.0, x_m = 20.0, y_m = 0.0}, '
        "{time_s = 1.0, x_m = 30.0, y_m = 0.0}]\n"
    )
    scene = read(tmp_path, text)
    _, at_frame = scene.at(1)
    _, at_camera = scene.at_camera(1, scene.cameras[0])
    assert at_frame[0].world_from_model[0, 3] == pytest.approx(21.0)
    assert at_camera[0].world_from_model[0, 3] == pytest.approx(21.5)
    assert scene.stamp_ns(1, scene.cameras[0]) - scene.stamp_ns(0, scene.cameras[0]) == 100_000_000


def test_directions_follow_from_movement_and_last_while_standing():
    path = MotionPath((Waypoint(0.0, 0.0, 0.0), Waypoint(1.0, 0.0, 5.0), Waypoint(2.0, 0.0, 5.0)))
    assert path.at(0.5).yaw_rad == pytest.approx(math.pi / 2)
    assert path.at(1.8).yaw_rad == pytest.approx(math.pi / 2)
    assert standing(1.0, 2.0, 3.0).at(9.0).yaw_rad == 3.0
