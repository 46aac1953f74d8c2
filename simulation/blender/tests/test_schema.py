"""Lines are checked once: what is right is read exactly, of what is wrong the mistake is said."""

import json

import pytest
from streams import FRONT, a_rig, a_scene, an_object

from roadwatch_viewer.errors import MalformedLine, NewerVersion
from roadwatch_viewer.schema import Rig, Scene, parse_line


def test_a_scene_is_read_to_the_last_digit():
    line = a_scene(
        7, 1557539956_450180001, [an_object(3, (12.25, -3.5, 0.75), yaw=1.25)], ego=(4e6, 5e5, 12.0)
    )
    scene = parse_line(json.dumps(line))
    assert isinstance(scene, Scene)
    assert (scene.seq, scene.stamp_ns, scene.frame) == (7, 1557539956_450180001, "base_link")
    assert scene.ego_pose.position_m.tolist() == [4e6, 5e5, 12.0]
    (seen,) = scene.objects
    assert (seen.position_m, seen.yaw_rad, seen.class_id) == ((12.25, -3.5, 0.75), 1.25, "car")


def test_an_unknown_heading_is_no_heading():
    scene = parse_line(json.dumps(a_scene(0, 0, [an_object(1, (1, 2, 3), yaw=None)])))
    assert scene.objects[0].yaw_rad is None


def test_the_rig_says_where_its_cameras_are():
    rig = parse_line(json.dumps(a_rig([FRONT])))
    assert isinstance(rig, Rig)
    (camera,) = rig.cameras
    assert (camera.fx, camera.fy, camera.cx, camera.cy) == (700.0, 690.0, 470.0, 280.0)
    assert camera.base_from_optical.apply([[0.0, 0.0, 1.0]])[0].round(9).tolist() == [2.7, 0.1, 1.4]


def test_unknown_types_and_keys_are_ignored():
    assert parse_line('{"type": "weather", "rain": true}') is None
    line = a_scene(0, 0, [an_object(1, (1, 2, 3)) | {"smell": "rubber"}]) | {"later": 1}
    assert isinstance(parse_line(json.dumps(line)), Scene)


def test_a_newer_version_is_refused_by_name():
    with pytest.raises(NewerVersion, match="roadwatch_scene version 2"):
        parse_line(json.dumps(a_rig(version=2)))


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda found: found.pop("size"), "size"),
        (lambda found: found["position"].update(x=float("nan")), "NaN"),
        (lambda found: found["position"].update(x=None), "None"),
        (lambda found: found["position"].update(y="left"), "left"),
        (lambda found: found.update(heading_known="yes"), "yes"),
        (lambda found: found.update(uuid={"uuid": [1, 2]}), "uuid"),
        (lambda found: found.update(track_id=1.5), "1.5"),
    ],
)
def test_a_broken_object_makes_the_line_malformed(change, said):
    found = an_object(1, (1, 2, 3))
    change(found)
    with pytest.raises(MalformedLine, match=said):
        parse_line(json.dumps(a_scene(0, 0, [found])))


@pytest.mark.parametrize(
    "line", [b"", b"{", b"[]", b"7", b'{"type": 3}', b'{"type": "scene"}', b"\xff\xfe", b"[" * 100_000]
)
def test_what_is_no_line_of_the_schema_is_malformed(line):
    with pytest.raises(MalformedLine):
        parse_line(line)


def test_without_tracking_the_camera_tells_equal_numbers_apart():
    first, second = (
        an_object(1, (1, 2, 3), state="untracked") | {"uuid": {"uuid": [0] * 16}} for _ in range(2)
    )
    second["seen_by"] = ["left"]
    scene = parse_line(json.dumps(a_scene(0, 0, [first, second])))
    assert scene.objects[0].key != scene.objects[1].key
