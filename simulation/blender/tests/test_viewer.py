"""The scene in Blender's data: where things are, what they look like, when they are there."""

import json
import math

import numpy as np
import pytest
from streams import FRONT, a_camera, a_rig, a_scene, an_object

from roadwatch_viewer.schema import parse_line
from roadwatch_viewer.settings import Settings

UTM = (4_412_345.678, 523_456.789, 231.5)
MM = 0.001


@pytest.fixture
def viewer(blender):
    """A live viewer in an empty file."""
    from roadwatch_viewer.stage.viewer import Viewer

    made = Viewer(blender, Settings())
    made.set_rig(parse_line(json.dumps(a_rig([FRONT]))))
    return made


def draw(viewer, *arguments, seq=0, time_ns=0, **named):
    import bpy

    drawn = viewer.draw(parse_line(json.dumps(a_scene(seq, time_ns, *arguments, **named))))
    bpy.context.view_layer.update()
    return drawn


def by_track(viewer):
    return {track.root.name.split()[1]: track for track in viewer.tracks.values()}


def in_base(viewer, thing):
    """Where an object of Blender's is in base_link."""
    return np.array(viewer.vehicle.base_link.matrix_world.inverted() @ thing.matrix_world.translation)


@pytest.mark.parametrize("frame", ["base_link", "odom"])
@pytest.mark.parametrize("driven_m", [0.0, 900.0])
def test_positions_are_the_streams_to_a_millimetre_at_utm_coordinates(viewer, frame, driven_m):
    rng = np.random.default_rng(4)
    yaw = 0.7
    points = np.column_stack([rng.uniform(-80, 80, 20), rng.uniform(-80, 80, 20), rng.uniform(0, 2, 20)])
    turn = np.array([[math.cos(yaw), -math.sin(yaw), 0], [math.sin(yaw), math.cos(yaw), 0], [0, 0, 1]])
    draw(viewer, [], ego=UTM)
    ego = np.array(UTM) + [driven_m, -driven_m, 3.0]
    said = points if frame == "base_link" else points @ turn.T + ego
    draw(viewer, [an_object(n, point) for n, point in enumerate(said)], frame=frame, ego=ego, ego_yaw=yaw)
    for name, track in by_track(viewer).items():
        np.testing.assert_allclose(in_base(viewer, track.root), points[int(name)], atol=MM)


def test_a_vehicle_that_drives_far_keeps_the_millimetre(viewer):
    draw(viewer, [], ego=UTM)
    for step in range(1, 20):
        draw(
            viewer,
            [an_object(1, (31.234, -7.891, 0.77))],
            ego=np.array(UTM) + [step * 30_000.0, 0.0, 0.0],
            ego_yaw=1.0,
        )
        np.testing.assert_allclose(
            in_base(viewer, by_track(viewer)["1"].root), (31.234, -7.891, 0.77), atol=MM
        )


def test_odometry_that_begins_late_moves_the_origin_along(viewer):
    draw(viewer, [an_object(1, (5.5, 1.25, 0.75))], motion="none")
    draw(viewer, [an_object(1, (5.5, 1.25, 0.75))], ego=UTM)
    np.testing.assert_allclose(in_base(viewer, by_track(viewer)["1"].root), (5.5, 1.25, 0.75), atol=MM)


def test_the_box_has_the_reported_size_and_the_body_fills_it(viewer):
    size = (5.2, 2.1, 1.7)
    draw(viewer, [an_object(1, (12.0, 3.0, 0.85), size=size, yaw=0.0)])
    box, body, _ = by_track(viewer)["1"].shown()
    assert tuple(box.dimensions) == pytest.approx(size, abs=MM)
    corners = np.array([list(body.matrix_world @ vertex.co) for vertex in body.data.vertices])
    assert corners[:, 0].max() - corners[:, 0].min() == pytest.approx(size[0], abs=0.02)
    assert corners[:, 2].min() == pytest.approx(0.0, abs=0.01)


def test_an_arrow_points_along_the_heading_and_is_absent_without_one(viewer):
    draw(viewer, [an_object(1, (9, 0, 1), yaw=math.pi / 2), an_object(2, (9, 9, 1), yaw=None)])
    known, unknown = by_track(viewer)["1"].shown(), by_track(viewer)["2"].shown()
    (arrow,) = [each for each in known if "arrow" in each.name]
    tip = max((arrow.matrix_world @ vertex.co for vertex in arrow.data.vertices), key=lambda point: point.y)
    assert tip.y > 2.25 and abs(tip.x - 9.0) < 0.01
    assert [each.name.split()[-1] for each in unknown] == ["box", "body"]
    assert unknown[0].data.name.endswith("unknown") and "block" in unknown[1].data.name


def test_a_heading_that_is_lost_takes_the_arrow_away_and_brings_it_back(viewer):
    track = None
    for yaw in (0.3, None, 0.3):
        draw(viewer, [an_object(1, (9, 0, 1), yaw=yaw)])
        track = by_track(viewer)["1"]
        arrows = [each for each in track.objects() if "arrow" in each.name]
        assert [each.hide_render for each in arrows] == [yaw is None]
        assert all(not each.hide_viewport for each in track.shown())
    assert len(list(track.objects())) == 1 + 3 + 2


def test_a_track_is_one_object_for_as_long_as_it_lives(viewer, blender):
    draw(viewer, [an_object(1, (9, 0, 1)), an_object(2, (19, 0, 1))])
    root = by_track(viewer)["1"].root
    count = len(blender.objects)
    for seq in range(1, 20):
        draw(viewer, [an_object(1, (9 + seq, 0, 1)), an_object(2, (19, 0, 1))], seq=seq, time_ns=seq * 10**8)
    assert by_track(viewer)["1"].root == root and len(blender.objects) == count


def test_a_track_that_is_gone_is_hidden_then_removed_and_a_new_one_reuses_its_meshes(viewer, blender):
    import bpy

    draw(viewer, [an_object(1, (9, 0, 1))])
    meshes, materials, count = len(bpy.data.meshes), len(bpy.data.materials), len(blender.objects)
    root = by_track(viewer)["1"]
    draw(viewer, [], time_ns=10**9)
    assert all(each.hide_render for each in root.objects() if each.type == "MESH")
    draw(viewer, [an_object(1, (9, 0, 1))], time_ns=2 * 10**9)
    assert by_track(viewer)["1"] is root and root.shown()
    draw(viewer, [], time_ns=20 * 10**9)
    assert len(viewer.tracks) == 0 and len(blender.objects) < count
    draw(viewer, [an_object(1, (9, 0, 1))], time_ns=21 * 10**9)
    assert (len(bpy.data.meshes), len(bpy.data.materials)) == (meshes, materials)


def test_colours_follow_the_track_not_the_run(blender):
    from roadwatch_viewer.stage.viewer import Viewer

    seen = []
    for first in (1, 5):
        viewer = Viewer(blender, Settings())
        draw(viewer, [an_object(track, (9, track, 1)) for track in range(first, 10)])
        seen.append(
            {
                name: track.shown()[0].material_slots[0].material.name
                for name, track in by_track(viewer).items()
            }
        )
    assert {name: seen[0][name] for name in seen[1]} == seen[1]
    assert len(set(seen[0].values())) > 6


def test_of_200_objects_the_25_nearest_are_seen_and_jitter_makes_none_flicker(blender):
    from roadwatch_viewer.stage.viewer import Viewer

    viewer = Viewer(blender, Settings(most_objects=25, range_m=500.0))
    rng = np.random.default_rng(6)
    far = rng.permutation(200) + 5.0
    angles = rng.uniform(0, 2 * np.pi, 200)
    for seq in range(10):
        radii = far + rng.normal(0, 0.2, 200) * (seq > 0)
        objects = [
            an_object(n, (r * math.cos(a), r * math.sin(a), 0.7))
            for n, (r, a) in enumerate(zip(radii, angles, strict=True))
        ]
        draw(viewer, objects, seq=seq, time_ns=seq * 10**8)
        seen = {int(name) for name, track in by_track(viewer).items() if track.shown()}
        assert seen == set(np.argsort(far)[:25].tolist())


def test_settings_change_what_is_drawn_next(viewer):
    objects = [an_object(n, (10.0 + n, 0, 1)) for n in range(10)]
    draw(viewer, objects)
    viewer.set_settings(Settings(most_objects=2, level_of_detail="boxes"))
    draw(viewer, objects)
    shown = {
        name: [each.name.split()[-1].split(".")[0] for each in track.shown()]
        for name, track in by_track(viewer).items()
    }
    assert {name: parts for name, parts in shown.items() if parts} == {
        "0": ["box", "arrow"],
        "1": ["box", "arrow"],
    }


@pytest.mark.parametrize("point", [(9.0, 0.5, 0.3), (14.0, -3.0, 2.0), (40.0, 11.0, 0.0)])
def test_a_camera_sees_a_point_at_its_pixel(viewer, blender, point):
    from bpy_extras.object_utils import world_to_camera_view
    from mathutils import Vector

    draw(viewer, [an_object(1, point, yaw=0.0)], ego=UTM, ego_yaw=0.4)
    viewer.vehicle.look_through("front")
    camera = viewer.vehicle.cameras["front"]
    seen = world_to_camera_view(blender, camera, Vector(by_track(viewer)["1"].root.matrix_world.translation))
    # The camera looks ahead from (1.7, 0.1, 1.4): right is -y, down is -z.
    depth, right, down = point[0] - 1.7, 0.1 - point[1], 1.4 - point[2]
    wanted = (700.0 * right / depth + 470.0, 690.0 * down / depth + 280.0)
    got = (seen.x * 960 - 0.5, (1.0 - seen.y) * 540 - 0.5)
    assert got == pytest.approx(wanted, abs=0.05)
    assert seen.z == pytest.approx(depth, abs=MM)


def test_another_rig_replaces_the_cameras_and_the_same_one_keeps_them(viewer, blender):
    before = viewer.vehicle.cameras["front"]
    viewer.set_rig(parse_line(json.dumps(a_rig([FRONT]))))
    assert viewer.vehicle.cameras["front"] == before
    back = a_camera(
        "back", (640, 480), (500, 0, 320, 0, 500, 240, 0, 0, 1), (-1, 0, 1), (0.5, 0.5, -0.5, -0.5)
    )
    viewer.set_rig(parse_line(json.dumps(a_rig([back]))))
    assert list(viewer.vehicle.cameras) == ["back"] and "camera front" not in blender.objects
    assert blender.camera.name == "overview"


def test_a_second_viewer_in_the_same_file_clears_the_first(blender):
    from roadwatch_viewer.stage.viewer import Viewer

    counts = []
    for _ in range(3):
        viewer = Viewer(blender, Settings(labels=True, trail_s=1.0))
        draw(viewer, [an_object(1, (9, 0, 1))])
        draw(viewer, [an_object(1, (10, 0, 1))], time_ns=10**8)
        counts.append(len(blender.objects))
    assert counts[0] == counts[1] == counts[2]


def test_people_riders_and_unknown_things_are_drawn(viewer):
    classes = ["person", "bicycle", "motorcycle", "bus", "truck", "zebra"]
    sizes = [(0.6, 0.6, 1.7), (1.8, 0.6, 1.7), (2.1, 0.8, 1.6), (11, 2.5, 3.1), (8, 2.4, 3.4), (2, 0.7, 1.5)]
    objects = [
        an_object(n, (10, 3 * n, s[2] / 2), size=s, class_id=c)
        for n, (c, s) in enumerate(zip(classes, sizes, strict=True))
    ]
    draw(viewer, objects)
    shown = {name: track.shown() for name, track in by_track(viewer).items()}
    for number, size in enumerate(sizes):
        assert tuple(shown[str(number)][0].dimensions) == pytest.approx(size, abs=MM)
    assert "block" in shown["5"][1].data.name and "pedestrian" in shown["0"][1].data.name
