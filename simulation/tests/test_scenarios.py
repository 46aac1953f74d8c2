"""Named scenarios and the random scenes for training: sound, varied, and the same for the same seed."""

from __future__ import annotations

import math

import numpy as np
import pytest

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
