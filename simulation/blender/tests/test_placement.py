"""Where things stand, in double precision."""

import json

import numpy as np
import pytest
from streams import a_scene, an_object

from roadwatch_viewer.colours import COLOURS, colour_index, linear_rgb
from roadwatch_viewer.kinds import kind_of
from roadwatch_viewer.placement import Placement, first_known_pose
from roadwatch_viewer.pose import about_z, euler_xyz
from roadwatch_viewer.schema import parse_line


def scene(*arguments, **named):
    return parse_line(json.dumps(a_scene(0, 0, *arguments, **named)))


def test_a_scene_in_base_link_is_put_where_the_vehicle_is():
    placed = Placement().place(
        scene([an_object(1, (10, 2, 0.75), yaw=0.25)], ego=(4e6, 5e5, 3.0), ego_yaw=np.pi / 2)
    )
    (only,) = placed.objects
    np.testing.assert_allclose(only.position_m, [4e6 - 2, 5e5 + 10, 3.75], atol=1e-9)
    assert only.euler_rad[2] == pytest.approx(np.pi / 2 + 0.25)
    assert only.distance_m == pytest.approx(np.hypot(10, 2))


def test_the_rig_says_what_its_frame_is_called():
    placement = Placement()
    placement.base_frame = "rear_axle"
    in_base = placement.place(scene([an_object(1, (10, 0, 0.75))], ego=(5.0, 0.0, 0.0), frame="rear_axle"))
    in_odom = placement.place(scene([an_object(1, (10, 0, 0.75))], ego=(5.0, 0.0, 0.0), frame="base_link"))
    assert in_base.objects[0].position_m[0] == pytest.approx(15.0)
    assert in_odom.objects[0].position_m[0] == pytest.approx(10.0)


def test_a_scene_in_odom_stays_and_distances_are_from_the_vehicle():
    placed = Placement().place(
        scene([an_object(1, (4e6 + 30, 5e5 + 40, 0.75), yaw=2.0)], frame="odom", ego=(4e6, 5e5, 0))
    )
    (only,) = placed.objects
    assert only.position_m.tolist() == [4e6 + 30, 5e5 + 40, 0.75]
    assert (only.distance_m, only.euler_rad[2]) == (pytest.approx(50.0), pytest.approx(2.0))


def test_while_nobody_tells_the_vehicle_stands_where_it_last_was():
    placement = Placement()
    placement.place(scene([], ego=(4e6, 5e5, 0.0)))
    placed = placement.place(scene([an_object(1, (5, 0, 0))], motion="none"))
    assert placed.objects[0].position_m.tolist() == [4e6 + 5, 5e5, 0.0]


def test_the_first_pose_is_the_first_that_is_known():
    scenes = [scene([], motion="none"), scene([], ego=(7, 8, 9)), scene([], ego=(1, 1, 1))]
    assert first_known_pose(scenes).position_m.tolist() == [7, 8, 9]
    assert first_known_pose(scenes[:1]) is None


def test_euler_angles_make_the_turn_again():
    rng = np.random.default_rng(5)
    wanted = rng.uniform(-1.2, 1.2, (50, 3))
    roll, pitch, yaw = wanted.T
    turns = about_z(yaw) @ _about(1, pitch) @ _about(0, roll)
    np.testing.assert_allclose(euler_xyz(turns), wanted, atol=1e-12)


def _about(axis, angles):
    turned = np.zeros((len(angles), 3, 3))
    first, second = (axis + 1) % 3, (axis + 2) % 3
    turned[:, axis, axis] = 1.0
    turned[:, first, first] = turned[:, second, second] = np.cos(angles)
    turned[:, first, second], turned[:, second, first] = -np.sin(angles), np.sin(angles)
    return turned


def test_colours_are_the_same_in_every_run_and_well_spread():
    assert (colour_index("front:1"), colour_index("00" * 16)) == (41, 17)
    counts = np.bincount([colour_index(f"track {number}") for number in range(4800)], minlength=COLOURS)
    assert counts.min() > 60 and counts.max() < 150
    colours = np.array([linear_rgb(index) for index in range(COLOURS)])
    gaps = np.linalg.norm(colours[:, None] - colours[None], axis=2) + np.eye(COLOURS)
    assert gaps.min() > 0.02 and colours.min() >= 0.0 and colours.max() <= 1.0


def test_every_class_has_a_kind_and_the_unknown_one_is_a_block():
    assert kind_of("person", (0.5, 0.5, 1.7)) == "pedestrian"
    assert kind_of("truck", (8.0, 2.4, 3.2)) == "truck"
    assert kind_of("truck", (5.4, 1.9, 1.8)) == "pickup"
    assert kind_of("zebra", (2.0, 0.6, 1.4)) == "block"
