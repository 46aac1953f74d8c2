"""The Blender renderer: the same geometry as the light renderer's; skipped where Blender cannot be."""

import dataclasses
import importlib
import sys

import numpy as np
import pytest
from little_scene import camera, ground, mask_box, pose

from roadwatch_simulation import catalogue
from roadwatch_simulation.errors import SimulationError
from roadwatch_simulation.model import Instance, Light

try:
    from roadwatch_simulation.blender import BlenderRenderer
except SimulationError as error:
    BlenderRenderer = None
    REASON = str(error)
else:
    REASON = ""

needs_blender = pytest.mark.skipif(BlenderRenderer is None, reason=f"BLENDER IS NOT TESTED: {REASON}")
SMALL = (160, 90)


def small_camera():
    return dataclasses.replace(camera(cx=75.3, cy=49.1, focal=130.0), width_px=SMALL[0], height_px=SMALL[1])


@pytest.fixture(scope="module")
def renderer():
    made = BlenderRenderer(*SMALL, samples=1)
    yield made
    made.close()


@needs_blender
def test_cycles_draws_a_car_where_the_ids_are(renderer):
    """The car is what differs from the empty picture when no sun throws its shadow and no ground takes it."""
    car = Instance(catalogue.build("sedan", 3), pose(8.0, 0.6, 0.5), object_id=2)
    grey = Light((0.4, -0.5, 0.75), sun=0.0)
    rendered = renderer.render([car], small_camera(), grey)
    empty = renderer.render([], small_camera(), grey)
    difference = np.abs(rendered.image_bgr.astype(int) - empty.image_bgr).max(axis=2) > 12
    np.testing.assert_allclose(mask_box(difference), rendered.silhouettes_px[2][1], atol=1.5)


@needs_blender
def test_the_same_scene_gives_the_same_bytes(renderer):
    things = [ground(), Instance(catalogue.build("compact", 1), pose(9.0, 0.0), object_id=1)]
    noon = Light((0.4, -0.5, 0.75))
    first, second = (renderer.render(things, small_camera(), noon).image_bgr for _ in range(2))
    np.testing.assert_array_equal(first, second)


@needs_blender
def test_lamps_and_wet_ground_can_be_drawn(renderer):
    things = [ground(), Instance(catalogue.build("suv", 1), pose(9.0, 0.0, 3.0), object_id=1)]
    dusk = Light((-0.6, -0.5, 0.14), sun=1.2, sky=0.4, warmth=0.9, wetness=1.0, headlights=True)
    image = renderer.render(things, small_camera(), dusk).image_bgr
    assert 5.0 < image.mean() < 200.0


def test_without_blender_the_error_says_what_to_do(monkeypatch):
    for name in [name for name in sys.modules if name.startswith("roadwatch_simulation.blender")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "bpy", None)
    with pytest.raises(SimulationError, match="bpy 4.5 exists for CPython 3.11 only"):
        importlib.import_module("roadwatch_simulation.blender")
