"""Named scenarios and the random scenes for training: sound, varied, and the same for the same seed."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from roadwatch_simulation.capture import Studio
from roadwatch_simulation.collisions import collisions
from roadwatch_simulation.errors import SimulationError
from roadwatch_simulation.scenarios import SCENARIOS, build_scenario
from roadwatch_simulation.scenarios.training import training_scene
from roadwatch_simulation.scenery import ENVIRONMENT_KINDS, Footprint, build_place


def poses(scene, frame: int) -> np.ndarray:
    return np.array([instance.world_from_model for instance in scene.at(frame)[1]])


@pytest.mark.parametrize("kind", ENVIRONMENT_KINDS)
def test_places_are_the_same_for_the_same_seed_and_differ_otherwise(kind):
    first = build_place(kind, 3)
    build_place.cache_clear()
    again, other = build_place(kind, 3), build_place(kind, 4)
    assert [len(i.model.mesh.positions) for i in first.instances] == [len(i.model.mesh.positions)
        for i in again.instances]
    for one, two in zip(first.instances, again.instances, strict=True):
        np.testing.assert_array_equal(one.model.mesh.positions, two.model.mesh.positions)
        np.testing.assert_array_equal(one.world_from_model, two.world_from_model)
    assert [len(i.model.mesh.positions) for i in first.instances] != [len(i.model.mesh.positions)
        for i in other.instances]


@pytest.mark.parametrize("kind", ENVIRONMENT_KINDS)
def test_places_stay_within_what_the_light_renderer_draws_quickly(kind):
    for seed in range(3):
        place = build_place(kind, seed)
        assert sum(len(instance.model.mesh.positions) for instance in place.instances) < 100_000
        assert all(instance.object_id == 0 and instance.model.object_class is None
            for instance in place.instances)


@pytest.mark.parametrize("kind", ENVIRONMENT_KINDS)
def test_normals_are_unit_vectors(kind):
    for instance in build_place(kind, 1).instances:
        lengths = np.linalg.norm(instance.model.mesh.normals, axis=2)
        np.testing.assert_allclose(lengths, 1.0, atol=1e-3)


@pytest.mark.parametrize("seed", range(4))
def test_nothing_in_a_training_scene_stands_inside_another(seed):
    for index in (0, 7, 13):
        assert collisions(training_scene(seed, index)) == []


def test_a_training_scene_is_the_same_for_the_same_seed_whatever_came_before():
    first = training_scene(5, 9)
    training_scene(5, 2)
    again = training_scene(5, 9)
    assert [(thing.kind, thing.seed) for thing in first.objects] == [(thing.kind, thing.seed)
        for thing in again.objects]
    np.testing.assert_array_equal(poses(first, 0), poses(again, 0))
    assert first.cameras == again.cameras
    assert first.light == again.light


def test_training_scenes_vary():
    scenes = [training_scene(6, index) for index in range(0, 48, 6)]
    assert len({scene.environment.seed for scene in scenes}) == len(scenes)
    assert len({scene.environment.kind for scene in scenes}) > 1
    assert {thing.kind for scene in scenes for thing in scene.objects} >= {"sedan", "pedestrian"}
    assert all(400.0 <= scene.cameras[0].fx <= 1100.0 for scene in scenes)


def test_the_y_path_runs_from_8_to_45_m_ahead():
    scene = build_scenario("paper_y_path", 0, 20)
    assert poses(scene, 0)[0, :2, 3] == pytest.approx([8.0, 0.0])
    assert poses(scene, 19)[0, :2, 3] == pytest.approx([45.0, 0.0])


def test_the_x_path_crosses_30_m_ahead():
    scene = build_scenario("paper_x_path", 0, 20)
    assert poses(scene, 0)[0, :2, 3] == pytest.approx([30.0, 12.0])
    assert poses(scene, 19)[0, :2, 3] == pytest.approx([30.0, -12.0])


def test_the_turntable_turns_once():
    scene = build_scenario("turntable", 0, 8)
    yaws = [math.degrees(math.atan2(*poses(scene, frame)[0, (1, 0), 0])) % 360.0 for frame in range(8)]
    assert yaws == pytest.approx([0, 45, 90, 135, 180, 225, 270, 315])


def test_the_whole_car_is_in_the_picture_on_every_cell_of_the_grid():
    scene = build_scenario("grid", 1)
    camera = scene.camera_at(0, scene.cameras[0])
    for frame in range(scene.frames):
        pose = poses(scene, frame)[0]
        length, width, height = scene.objects[0].model.size_lwh_m
        signs = (-0.5, 0.5)
        corners = np.array([(length * x, width * y, height * z) for x in signs for y in signs
            for z in (0, 1)])
        pixels = camera.project(corners @ pose[:3, :3].T + pose[:3, 3])
        assert (pixels[:, 0] > 0).all()
        assert (pixels[:, 0] < camera.width_px).all()


def test_traffic_moves_around_the_rig_and_never_touches():
    scene = build_scenario("traffic", 2, 24)
    assert collisions(scene) == []
    assert len(scene.cameras) == 6
    assert len(scene.moving_ids()) >= 10
    ego = [scene.ego.at(scene.time_s(frame)) for frame in range(scene.frames)]
    assert ego[-1].x_m - ego[0].x_m > 10.0
    for frame in (0, 12, 23):
        body = Footprint(ego[frame].x_m, ego[frame].y_m, ego[frame].yaw_rad, 4.8, 2.0)
        assert not any(thing.footprint(scene.time_s(frame)).overlaps(body) for thing in scene.objects)


def test_a_short_drive_is_the_beginning_of_a_longer_one():
    short, longer = build_scenario("traffic", 2, 1), build_scenario("traffic", 2, 24)
    np.testing.assert_array_equal(poses(short, 0), poses(longer, 0))


def test_unknown_scenarios_and_empty_ones_are_refused():
    with pytest.raises(SimulationError, match="there are paper_x_path"):
        build_scenario("moon")
    with pytest.raises(SimulationError, match="at least 1 frame"):
        build_scenario("grid", 0, 0)
    assert set(SCENARIOS) >= {"paper_x_path", "paper_y_path", "turntable", "grid", "traffic", "training"}


def test_the_long_path_runs_from_6_to_60_m_ahead():
    scene = build_scenario("long_path", 0, 10)
    assert poses(scene, 0)[0, :2, 3] == pytest.approx([6.0, 0.0])
    assert poses(scene, 9)[0, :2, 3] == pytest.approx([60.0, 0.0])


def test_every_kind_of_vehicle_is_shown_and_none_stands_before_another():
    scene = build_scenario("vehicles", 1, 8)
    shown = [[thing.footprint(scene.time_s(frame)) for thing in scene.objects] for frame in range(8)]
    in_view = [[index for index, at in enumerate(frame) if at.x_m > 0.0] for frame in shown]
    assert {index for frame in in_view for index in frame} == set(range(len(scene.objects)))
    for frame, visible in zip(shown, in_view, strict=True):
        angles = sorted((angles.min(), angles.max()) for angles in
            (np.arctan2(*frame[index].corners().T[::-1]) for index in visible))
        assert all(before[1] < after[0] for before, after in zip(angles, angles[1:], strict=False))
        assert -0.602 < angles[0][0] and angles[-1][1] < 0.602


def test_cars_in_a_row_stand_side_by_side_and_face_away():
    scene = build_scenario("car_row", 0, 6)
    for frame, ahead in enumerate((15.0, 30.0, 45.0, 15.0, 30.0, 45.0)):
        shown = [pose for pose in poses(scene, frame) if pose[0, 3] > 0.0]
        assert sorted(pose[1, 3] for pose in shown) == pytest.approx([-8.0, 0.0, 8.0])
        assert all(pose[0, 3] == pytest.approx(ahead) and pose[0, 0] == pytest.approx(1.0) for pose in shown)
    assert len({car.model.size_lwh_m for car in scene.objects}) == 6


TRACKING = [name for name in SCENARIOS if name.startswith("tracking_")]


def speeds_and_turns(path, end_s: float) -> tuple[np.ndarray, np.ndarray]:
    """Speeds (m/s) and how fast the direction turns (rad/s), every tenth of a second."""
    at = [path.at(time) for time in np.arange(0.0, end_s, 0.1)]
    steps = np.diff([(pose.x_m, pose.y_m) for pose in at], axis=0)
    return np.linalg.norm(steps, axis=1) / 0.1, np.abs(np.diff([pose.yaw_rad for pose in at])) / 0.1


def seen(scene, index: int, frame: int) -> set[str]:
    """Names of the cameras in whose picture the middle of that object lies."""
    found = set()
    for mount in scene.cameras:
        thing = scene.at_camera(frame, mount)[1][index]
        middle = thing.world_from_model @ [0.0, 0.0, 0.5 * thing.model.size_lwh_m[2], 1.0]
        x, y, depth = scene.camera_at(frame, mount).project(middle[None, :3])[0]
        if depth > 0.0 and 0.0 <= x < mount.width_px and 0.0 <= y < mount.height_px:
            found.add(mount.name)
    return found


def first_seen(scene, index: int) -> list[str]:
    """Names of the cameras that see an object, in the order in which they first do."""
    order: list[str] = []
    for frame in range(scene.frames):
        order += sorted(seen(scene, index, frame) - set(order))
    return order


def from_ego(scene, index: int, frame: int) -> np.ndarray:
    """How far ahead of the rig and to its left an object is (m)."""
    world_from_base, things = scene.at(frame)
    return (np.linalg.inv(world_from_base) @ things[index].world_from_model)[:2, 3]


@pytest.mark.parametrize("seed", [1, 5])
@pytest.mark.parametrize("name", TRACKING)
def test_tracking_scenarios_are_sound_and_move_as_things_do(name, seed):
    scene = build_scenario(name, seed)
    assert collisions(scene) == []
    assert (scene.rate_hz, len(scene.cameras)) == (10.0, 6)
    assert 80 <= scene.frames <= 100 and 3 <= len(scene.objects) <= 40
    for frame in range(scene.frames):
        at = scene.ego.at(scene.time_s(frame))
        body = Footprint(at.x_m, at.y_m, at.yaw_rad, 4.8, 2.0)
        assert not any(thing.footprint(scene.time_s(frame)).overlaps(body) for thing in scene.objects)
    walking = [thing.path for thing in scene.objects if thing.kind == "pedestrian"]
    moving = [thing.path for thing in scene.objects if thing.path.is_moving]
    for path in [*moving, *([scene.ego] if scene.ego.is_moving else [])]:
        speeds, turns = speeds_and_turns(path, scene.time_s(scene.frames))
        slowest, fastest = (0.8, 1.8) if path in walking else (3.0, 14.0)
        assert slowest < speeds.min() and speeds.max() < fastest
        assert np.abs(np.diff(speeds)).max() < 0.4, "brakes or speeds up by more than 4 m/s^2"
        assert (speeds * turns).max() < 5.0, "turns with more than 5 m/s^2 sideways"


@pytest.mark.parametrize("name", TRACKING)
def test_a_tracking_scenario_is_the_same_again_and_a_short_one_its_beginning(name):
    short, longer = build_scenario(name, 1, 3), build_scenario(name, 1)
    assert short.objects == longer.objects
    np.testing.assert_array_equal(poses(short, 2), poses(longer, 2))
    assert short.environment == longer.environment


def test_most_rigs_for_tracking_fire_their_cameras_one_after_another():
    delays = [[camera.delay_s for camera in build_scenario(name, 1, 1).cameras] for name in TRACKING]
    assert sum(len(set(each)) == 6 and max(each) <= 0.08 for each in delays) >= len(TRACKING) / 2


def test_crossing_vehicles_come_from_both_sides_and_two_pass_each_other():
    scene = build_scenario("tracking_crossing", 1)
    sides = np.array([[from_ego(scene, index, frame)[1] > 0.0 for index in range(4)] for frame in (0, 79)])
    np.testing.assert_array_equal(sides, [[True, True, False, False], [False, False, True, True]])
    both = [frame for frame in range(80) if all("front" in seen(scene, index, frame) for index in (0, 2))]
    angles = [[math.atan2(*from_ego(scene, index, frame)[::-1]) for index in (0, 2)] for frame in both]
    assert angles[0][0] > angles[0][1] and angles[-1][0] < angles[-1][1]


def test_one_car_overtakes_and_another_is_overtaken():
    scene = build_scenario("tracking_overtaking", 1)
    assert from_ego(scene, 0, 0)[0] < -10.0 and from_ego(scene, 0, 79)[0] > 10.0
    assert from_ego(scene, 1, 0)[0] > 10.0 and from_ego(scene, 1, 79)[0] < -10.0
    assert first_seen(scene, 0) == ["back", "left", "front_left", "front"]


def test_the_bus_hides_each_of_two_cars_for_a_while():
    scene = build_scenario("tracking_occlusion", 1)
    front = scene.cameras[1]
    small = replace(front, width_px=240, height_px=135, fx=front.fx / 4, fy=front.fy / 4, cx=119.5, cy=67.0)
    scene, studio = replace(scene, cameras=(small,)), Studio()
    hidden: dict[str, list[float]] = {"2": [], "3": []}
    for frame in range(0, 80, 2):
        for thing in studio.capture(scene, frame, 0).objects:
            if thing["id"] in hidden and thing["truncated"] == 0.0:
                hidden[thing["id"]].append(thing["occluded"])
    for shares in hidden.values():
        assert 5 <= sum(share > 0.9 for share in shares) <= 12, "a fifth of a second each"
        gone = shares.index(max(shares))
        assert min(shares[:gone]) < 0.1 and min(shares[gone:]) < 0.1


def test_the_rig_passes_parked_cars_on_both_sides():
    scene = build_scenario("tracking_parked_row", 1)
    assert scene.moving_ids() == frozenset()
    assert speeds_and_turns(scene.ego, 8.0)[0] == pytest.approx(10.0)
    passed = [from_ego(scene, index, 0)[1] for index in range(len(scene.objects))
        if from_ego(scene, index, 0)[0] > 0.0 > from_ego(scene, index, 79)[0]]
    assert min(sum(left > 0.0 for left in passed), sum(left < 0.0 for left in passed)) >= 5


def test_the_car_that_turns_round_comes_back_past_the_rig():
    scene = build_scenario("tracking_u_turn", 1)
    first, last = (scene.objects[0].path.at(scene.time_s(frame)) for frame in (0, 79))
    assert last.yaw_rad - first.yaw_rad == pytest.approx(math.pi, abs=0.02)
    assert from_ego(scene, 0, 0)[0] > 15.0 and from_ego(scene, 0, 79)[0] < -10.0


def test_the_circling_car_is_handed_over_from_camera_to_camera():
    scene = build_scenario("tracking_handover", 1)
    assert first_seen(scene, 0) == ["back", "right", "front_right", "front", "front_left", "left"]
    assert all(seen(scene, 0, frame) for frame in range(scene.frames))
    assert "back" in seen(scene, 0, scene.frames - 1)


def test_the_rig_turns_by_90_degrees():
    scene = build_scenario("tracking_turning", 1)
    assert scene.ego.at(8.0).yaw_rad - scene.ego.at(0.0).yaw_rad == pytest.approx(math.pi / 2, abs=0.01)
    assert len(scene.moving_ids()) == 5 and len(scene.objects) > 8


def test_people_walk_past_each_other_before_the_rig():
    scene = build_scenario("tracking_people", 1)
    assert {thing.kind for thing in scene.objects} == {"pedestrian"}
    apart = [[from_ego(scene, index, frame)[1] for index in (0, 1)] for frame in (0, 79)]
    assert (apart[0][0] - apart[0][1]) * (apart[1][0] - apart[1][1]) < 0.0
    assert {"front"} <= set(first_seen(scene, 0)) & set(first_seen(scene, 1))
