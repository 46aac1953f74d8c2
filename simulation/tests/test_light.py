"""The light renderer: what it draws is where the camera model says, and its ids are exact."""

import dataclasses
import hashlib

import numpy as np
import pytest
from little_scene import HEIGHT, NOON, WIDTH, camera, ground, mask_box, pose, wall

from roadwatch_simulation import catalogue
from roadwatch_simulation.errors import SimulationError
from roadwatch_simulation.light import LightRenderer
from roadwatch_simulation.light import context as light_context
from roadwatch_simulation.model import Instance, Light, Surface


@pytest.fixture(scope="module")
def renderer():
    made = LightRenderer(WIDTH, HEIGHT)
    yield made
    made.close()


def vertices_px(instance, view, chosen=slice(None)):
    points = instance.model.mesh.positions[chosen].reshape(-1, 3).astype(float)
    matrix = instance.world_from_model
    return view.project(points @ matrix[:3, :3].T + matrix[:3, 3])


def box_of(points_px):
    """The box of projected points, edges, clipped to the image."""
    low, high = points_px[:, :2].min(axis=0) + 0.5, points_px[:, :2].max(axis=0) + 0.5
    size = (WIDTH, HEIGHT)
    return (*np.clip(low, 0, size), *np.clip(high, 0, size))


@pytest.mark.parametrize("place", [(9.0, 1.0, 0.4), (14.0, -3.0, 2.9), (25.0, 2.0, -1.2), (7.0, 4.5, 1.5)])
def test_an_object_is_drawn_where_the_camera_projects_its_vertices(renderer, place):
    car = Instance(catalogue.build("sedan", 3), pose(*place), object_id=7)
    rendered = renderer.render([car], camera(), NOON)
    expected = box_of(vertices_px(car, camera()))
    _, silhouette = rendered.silhouettes_px[7]
    np.testing.assert_allclose(silhouette, expected, atol=1.0)
    np.testing.assert_allclose(mask_box(rendered.object_ids == 7), expected, atol=1.0)


def test_parts_are_drawn_where_the_camera_projects_them(renderer):
    car = Instance(catalogue.build("compact", 1), pose(7.0, 0.6, 0.5), object_id=3)
    rendered = renderer.render([car], camera(), NOON)
    names = list(car.model.part_centers_m)
    seen = 0
    for number, name in enumerate(names, start=1):
        mask = (rendered.object_ids == 3) & (rendered.part_ids == number)
        if not mask.any():
            continue
        outline = box_of(vertices_px(car, camera(), car.model.mesh.parts == number))
        left, top, right, bottom = mask_box(mask)
        assert left >= outline[0] - 1.0 and top >= outline[1] - 1.0, name
        assert right <= outline[2] + 1.0 and bottom <= outline[3] + 1.0, name
        seen += 1
    assert seen >= 4


def test_a_small_part_is_centred_on_its_projected_centre(renderer):
    model = catalogue.build("sedan", 2)
    number = 1 + list(model.part_centers_m).index("plate_rear")
    car = Instance(model, pose(8.0, 0.3, 0.1), object_id=1)
    rendered = renderer.render([car], camera(), NOON)
    left, top, right, bottom = mask_box(rendered.part_ids == number)
    matrix = car.world_from_model
    center = matrix[:3, :3] @ np.array(model.part_centers_m["plate_rear"]) + matrix[:3, 3]
    x, y, _ = camera().project(center[None])[0]
    assert abs((left + right) / 2.0 - 0.5 - x) <= 1.0
    assert abs((top + bottom) / 2.0 - 0.5 - y) <= 1.0


def test_a_silhouette_ignores_what_stands_in_front(renderer):
    car = Instance(catalogue.build("suv", 4), pose(15.0, 0.0, 0.3), object_id=9)
    free = renderer.render([car], camera(), NOON)
    hidden = renderer.render([car, wall(8.0, 0.2, 6.0)], camera(), NOON)
    assert hidden.silhouettes_px == free.silhouettes_px
    count = free.silhouettes_px[9][0]
    assert np.count_nonzero(free.object_ids == 9) == count
    assert 0 < np.count_nonzero(hidden.object_ids == 9) < count


def test_silhouettes_of_overlapping_objects_are_each_their_own(renderer):
    near = Instance(catalogue.build("sedan", 1), pose(10.0, 0.0, 0.1), object_id=1)
    far = Instance(catalogue.build("van", 1), pose(18.0, 0.4, 0.0), object_id=2)
    both = renderer.render([near, far], camera(), NOON)
    for instance in (near, far):
        alone = renderer.render([instance], camera(), NOON)
        assert both.silhouettes_px[instance.object_id] == alone.silhouettes_px[instance.object_id]


def test_objects_outside_the_image_have_no_silhouette(renderer):
    model = catalogue.build("sedan", 1)
    behind = Instance(model, pose(-12.0, 0.0), object_id=1)
    beside = Instance(model, pose(5.0, 30.0), object_id=2)
    rendered = renderer.render([behind, beside], camera(), NOON)
    assert rendered.silhouettes_px == {}
    assert not rendered.object_ids.any()


def test_an_object_partly_behind_the_camera_is_still_drawn(renderer):
    car = Instance(catalogue.build("sedan", 1), pose(1.0, 2.2), object_id=5)
    rendered = renderer.render([car], camera(), NOON)
    count, box = rendered.silhouettes_px[5]
    assert count > 100
    assert box[0] == 0.0


def test_the_same_scene_gives_the_same_bytes(renderer):
    instances = [ground(), Instance(catalogue.build("wagon", 2), pose(11.0, 1.0, 0.7), object_id=1)]
    other = LightRenderer(WIDTH, HEIGHT)
    pictures = [drawer.render(instances, camera(), NOON) for drawer in (renderer, renderer, other)]
    other.close()
    hashes = {hashlib.sha256(picture.image_bgr.tobytes()).hexdigest() for picture in pictures}
    assert len(hashes) == 1


def test_the_sun_throws_a_shadow_and_an_overcast_sky_does_not(renderer):
    things = [ground(), Instance(catalogue.build("van", 2), pose(14.0, 0.0, 1.57), object_id=1)]
    low_sun = Light(sun_direction=(0.0, 0.8, 0.5))
    x, y, _ = camera().project(np.array([[14.0, -4.5, 0.0]]))[0]
    patch = (slice(int(y) - 1, int(y) + 2), slice(int(x) - 4, int(x) + 5))

    def darkening(light):
        with_van = renderer.render(things, camera(), light).image_bgr[patch]
        bare = renderer.render(things[:1], camera(), light).image_bgr[patch]
        return with_van.mean() / bare.mean()

    assert darkening(low_sun) < 0.75
    assert darkening(dataclasses.replace(low_sun, sun=0.0)) > 0.95


@pytest.mark.parametrize("surface", list(Surface))
def test_every_surface_can_be_drawn_in_every_light(renderer, surface):
    dusk = Light((-0.6, -0.5, 0.14), sun=1.2, sky=0.4, warmth=0.9, headlights=True)
    for light in (NOON, dusk, dataclasses.replace(NOON, sun=0.0, wetness=1.0)):
        image = renderer.render([ground(surface)], camera(), light).image_bgr
        lower = image[140:].astype(float)
        assert 8.0 < lower.mean() < 230.0


def test_a_camera_of_another_size_is_refused(renderer):
    with pytest.raises(SimulationError, match="one renderer per image size"):
        renderer.render([], dataclasses.replace(camera(), width_px=WIDTH + 2), NOON)


def test_a_machine_without_egl_is_told_what_to_install(monkeypatch):
    def fail(**_):
        raise OSError("libEGL.so.1: cannot open shared object file")

    monkeypatch.setattr(light_context.moderngl, "create_standalone_context", fail)
    with pytest.raises(SimulationError, match="libegl1 and libgl1-mesa-dri"):
        LightRenderer(WIDTH, HEIGHT)
