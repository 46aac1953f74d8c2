"""Truth of a picture: boxes, angles, occlusion and parts from real geometry."""

import numpy as np
import pytest
from little_scene import HEIGHT, NOON, WIDTH, camera, pose, wall

from roadwatch_simulation import catalogue
from roadwatch_simulation.light import LightRenderer
from roadwatch_simulation.model import Camera, Instance, Light
from roadwatch_simulation.truth import cuboid_box, object_truth


@pytest.fixture(scope="module")
def renderer():
    made = LightRenderer(WIDTH, HEIGHT)
    yield made
    made.close()


def turned_camera(yaw_rad):
    """A camera at the origin of base_link that looks along `yaw_rad`."""
    view = camera()
    world_from_camera = view.world_from_camera.copy()
    world_from_camera[:3, :3] = pose(0.0, 0.0, yaw_rad)[:3, :3] @ world_from_camera[:3, :3]
    return Camera(WIDTH, HEIGHT, view.fx, view.fy, view.cx, view.cy, world_from_camera)


def truth_of(renderer, instances, view=None, base_from_world=None):
    view = view or camera()
    rendered = renderer.render(instances, view, NOON)
    return object_truth(instances, view, rendered, np.eye(4) if base_from_world is None else base_from_world)


def test_a_free_car_has_its_box_and_nothing_hidden(renderer):
    car = Instance(catalogue.build("sedan", 3), pose(12.0, 0.5, 0.3), object_id=4)
    (found,) = truth_of(renderer, [car])
    assert (found["id"], found["class"], found["label"]) == ("4", "car", "sedan")
    assert found["truncated"] == 0.0
    assert found["occluded"] == 0.0
    box, silhouette = found["box_px"], found["silhouette_px"]
    # Mirrors stand out of the cuboid, whose width is without them.
    assert silhouette[1] >= box[1] - 1.0 and silhouette[3] <= box[3] + 1.0
    assert found["visible_px"] == silhouette


def test_the_centre_is_half_the_height_above_the_ground(renderer):
    car = Instance(catalogue.build("suv", 3), pose(12.0, 0.5, 0.3), object_id=4)
    (found,) = truth_of(renderer, [car])
    height = car.model.size_lwh_m[2]
    np.testing.assert_allclose(found["center_base_m"], [12.0, 0.5, height / 2.0], atol=1e-3)
    np.testing.assert_allclose(found["center_camera_m"], [-0.5, 1.5 - height / 2.0, 12.0], atol=1e-3)


def test_base_link_moves_with_the_vehicle(renderer):
    base_from_world = np.linalg.inv(pose(2.0, 1.0, 0.5))
    car = Instance(catalogue.build("sedan", 3), pose(12.0, 0.5, 0.3), object_id=4)
    (found,) = truth_of(renderer, [car], base_from_world=base_from_world)
    expected = base_from_world @ [12.0, 0.5, 0.0, 1.0]
    np.testing.assert_allclose(found["center_base_m"][:2], expected[:2], atol=1e-3)
    assert found["yaw_base_rad"] == pytest.approx(0.3 - 0.5, abs=1e-4)


@pytest.mark.parametrize("camera_yaw_rad", [0.0, 0.4, -0.3])
@pytest.mark.parametrize("heading_rad", [0.0, 1.2, -2.5, 3.0])
def test_rotation_y_is_kittis(renderer, heading_rad, camera_yaw_rad):
    """About the optical y axis, zero along x: a car that heads along the optical axis has -90 degrees."""
    place = pose(*(12.0 * np.array([np.cos(camera_yaw_rad), np.sin(camera_yaw_rad)])), heading_rad)
    car = Instance(catalogue.build("sedan", 3), place, object_id=1)
    (found,) = truth_of(renderer, [car], turned_camera(camera_yaw_rad))
    expected = -np.pi / 2.0 - (heading_rad - camera_yaw_rad)
    difference = found["rotation_y_rad"] - expected
    assert np.cos(difference) == pytest.approx(1.0, abs=1e-6)
    assert found["yaw_base_rad"] == pytest.approx(heading_rad, abs=1e-4)


def test_kittis_corners_give_the_same_box(renderer):
    """Corners built from rotation_y as KITTI's development kit does project to the box."""
    car = Instance(catalogue.build("van", 1), pose(13.0, -1.5, 0.9), object_id=1)
    (found,) = truth_of(renderer, [car])
    length, width, height = found["size_lwh_m"]
    cos, sin = np.cos(found["rotation_y_rad"]), np.sin(found["rotation_y_rad"])
    turn = np.array([[cos, 0, sin], [0, 1, 0], [-sin, 0, cos]])
    signs = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    corners = np.array(signs) * [length / 2, height / 2, width / 2] @ turn.T + found["center_camera_m"]
    view = camera()
    x = view.fx * corners[:, 0] / corners[:, 2] + view.cx + 0.5
    y = view.fy * corners[:, 1] / corners[:, 2] + view.cy + 0.5
    np.testing.assert_allclose(found["box_px"], [x.min(), y.min(), x.max(), y.max()], atol=0.02)


def test_truncated_is_the_share_of_the_box_outside_the_image():
    car = Instance(catalogue.build("sedan", 3), pose(10.0, 5.2, 0.0), object_id=1)
    (left, top, right, bottom), truncated = cuboid_box(car, camera())
    wide = camera(cx=camera().cx + 400.0)
    wide = Camera(2000, HEIGHT, wide.fx, wide.fy, wide.cx, wide.cy, wide.world_from_camera)
    (free_left, _, free_right, _), free = cuboid_box(car, wide)
    assert free == 0.0
    assert left == 0.0
    assert 1.0 - (right - left) / (free_right - free_left) == pytest.approx(truncated, abs=1e-6)
    assert 0.1 < truncated < 0.9
    assert bottom > top


def test_a_cuboid_that_reaches_behind_the_camera_is_cut_there(renderer):
    car = Instance(catalogue.build("sedan", 3), pose(1.5, 2.0, 0.0), object_id=1)
    (found,) = truth_of(renderer, [car])
    assert found["box_px"][0] == 0.0
    assert 0.0 < found["box_px"][2] <= WIDTH
    assert 0.3 < found["truncated"] <= 1.0


def test_a_wholly_hidden_object_is_kept(renderer):
    car = Instance(catalogue.build("sedan", 3), pose(20.0, 0.0, 0.0), object_id=1)
    (found,) = truth_of(renderer, [car, wall(8.0, -3.0, 3.0)])
    assert found["occluded"] == 1.0
    assert found["visible_px"] is None
    assert not any(part["visible"] for part in found["parts"])


def test_a_half_hidden_object_is_half_occluded(renderer):
    car = Instance(catalogue.build("van", 3), pose(20.0, 0.0, 0.0), object_id=1)
    (found,) = truth_of(renderer, [car, wall(19.0 - car.model.size_lwh_m[0], 0.0, 6.0)])
    assert 0.4 < found["occluded"] < 0.6


def test_parts_on_the_far_side_are_not_visible(renderer):
    car = Instance(catalogue.build("sedan", 3), pose(9.0, 0.0, np.pi / 2.0), object_id=1)
    (found,) = truth_of(renderer, [car])
    parts = {part["name"]: part for part in found["parts"]}
    # The car points to the left of the picture, so the camera sees its left side.
    for name in ("tyre_front_left", "tyre_rear_left"):
        assert parts[name]["visible"]
        assert not parts[name.replace("left", "right")]["visible"]
    near = parts["tyre_front_left"]
    left, top, right, bottom = near["box_px"]
    assert abs((left + right) / 2.0 - 0.5 - near["x_px"]) <= 1.0
    assert top < near["y_px"] < bottom


def test_objects_out_of_sight_and_scenery_have_no_truth(renderer):
    model = catalogue.build("sedan", 3)
    things = [Instance(model, pose(-9.0, 0.0), object_id=1), Instance(model, pose(12.0, 0.0), object_id=0)]
    assert truth_of(renderer, things) == []


def test_moving_objects_are_not_stationary(renderer):
    car = Instance(catalogue.build("sedan", 3), pose(12.0, 0.5), object_id=4)
    rendered = renderer.render([car], camera(), Light(sun_direction=(0.0, 0.0, 1.0)))
    (parked,) = object_truth([car], camera(), rendered, np.eye(4))
    (driven,) = object_truth([car], camera(), rendered, np.eye(4), moving_ids={4})
    assert parked["stationary"] is True
    assert driven["stationary"] is False
