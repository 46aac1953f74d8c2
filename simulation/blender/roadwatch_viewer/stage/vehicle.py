"""The vehicle: an empty `base_link`, an outline of the car, and the rig's cameras as cameras of Blender."""

from __future__ import annotations

import bpy
import mathutils
import numpy as np

from .. import shapes
from ..pose import Pose
from ..schema import Rig, RigCamera
from ..settings import Settings
from .layers import Layers, remove_objects
from .meshes import to_blender

SENSOR_WIDTH_MM = 36.0
CLIP_START_M, CLIP_END_M = 0.05, 3000.0
CONE_REACH_M = 1.2
SIZE_KEY, ASPECT_KEY = "roadwatch_size_px", "roadwatch_fx_over_fy"
OVERVIEW, TOP = "overview", "top"
# Blender's cameras look along their -z and have y up; optical axes have z forward and y down.
OPTICAL_FROM_BLENDER = np.diag([1.0, -1.0, -1.0])


class Vehicle:
    """`base_link` and everything that moves with it."""

    def __init__(self, scene: bpy.types.Scene, layers: Layers, settings: Settings) -> None:
        self._scene, self._layers = scene, layers
        self.base_link = layers.empty("base_link", "vehicle")
        self.base_link.empty_display_type = "ARROWS"
        self.base_link.empty_display_size = 2.0
        self.outline = _new_outline(layers, self.base_link, settings)
        self.rig: Rig | None = None
        self.cameras: dict[str, bpy.types.Object] = {}
        self._cones: list[bpy.types.Object] = []
        self.views = {OVERVIEW: self._new_overview(), TOP: self._new_top()}
        scene.camera = self.views[OVERVIEW]

    def set_rig(self, rig: Rig) -> None:
        """Puts the rig's cameras up; the same rig again changes nothing."""
        if rig == self.rig:
            return
        remove_objects([*self.cameras.values(), *self._cones])
        self._scene.camera = self._scene.camera or self.views[OVERVIEW]
        self.rig = rig
        self.cameras = {camera.name: self._new_camera(camera) for camera in rig.cameras}
        self._cones = [self._new_cone(camera) for camera in rig.cameras]

    def hide_from_view(self, view: str) -> None:
        """Takes outline and cones out of pictures of the rig's own cameras, which stand inside them."""
        is_inside = view in self.cameras
        for each in (self.outline, *self._cones):
            each.hide_render = is_inside

    def look_through(self, view: str) -> None:
        """Makes a view the scene's camera, with that camera's own resolution."""
        look_through(self._scene, self.cameras.get(view) or self.views[view])
        self.hide_from_view(view)

    def view_names(self) -> list[str]:
        """What `look_through` takes."""
        return [*self.views, *self.cameras]

    def size_px(self, camera: str) -> tuple[int, int]:
        """Width and height of a rig's camera's images."""
        width_px, height_px = self.cameras[camera][SIZE_KEY]
        return width_px, height_px

    def _new_camera(self, camera: RigCamera) -> bpy.types.Object:
        lens = bpy.data.cameras.new(camera.name)
        lens.sensor_fit = "HORIZONTAL"
        lens.sensor_width = SENSOR_WIDTH_MM
        lens.lens = camera.fx * SENSOR_WIDTH_MM / camera.width_px
        lens.shift_x = -(camera.cx + 0.5 - camera.width_px / 2.0) / camera.width_px
        lens.shift_y = (camera.cy + 0.5 - camera.height_px / 2.0) / camera.width_px * camera.fx / camera.fy
        lens.clip_start, lens.clip_end = CLIP_START_M, CLIP_END_M
        lens.display_size = 0.3
        made = self._layers.object(f"camera {camera.name}", lens, "vehicle", self.base_link)
        made.matrix_local = _matrix(camera.base_from_optical, OPTICAL_FROM_BLENDER)
        made[SIZE_KEY], made[ASPECT_KEY] = (camera.width_px, camera.height_px), camera.fx / camera.fy
        return made

    def _new_cone(self, camera: RigCamera) -> bpy.types.Object:
        focal_px = (camera.fx, camera.fy)
        mesh = shapes.cone(camera.width_px, camera.height_px, focal_px, CONE_REACH_M)
        name = f"cone {camera.name}"
        made = self._layers.object(name, to_blender(name, mesh), "vehicle", self.base_link)
        made.matrix_local = _matrix(camera.base_from_optical, np.eye(3))
        return made

    def _new_overview(self) -> bpy.types.Object:
        """From behind and above, looking ahead."""
        lens = bpy.data.cameras.new(OVERVIEW)
        lens.lens, lens.clip_end = 28.0, CLIP_END_M
        made = self._layers.object(OVERVIEW, lens, "vehicle", self.base_link)
        place, target = mathutils.Vector((-19.0, 0.0, 13.0)), mathutils.Vector((9.0, 0.0, 0.0))
        turn = (target - place).to_track_quat("-Z", "Y")
        made.matrix_local = mathutils.Matrix.Translation(place) @ turn.to_matrix().to_4x4()
        return made

    def _new_top(self) -> bpy.types.Object:
        """From straight above, ahead upwards."""
        lens = bpy.data.cameras.new(TOP)
        lens.type, lens.ortho_scale, lens.clip_end = "ORTHO", 130.0, CLIP_END_M
        made = self._layers.object(TOP, lens, "vehicle", self.base_link)
        made.matrix_local = mathutils.Matrix.Translation((10.0, 0.0, 150.0)) @ mathutils.Matrix.Rotation(
            -np.pi / 2.0, 4, "Z"
        )
        return made


def look_through(scene: bpy.types.Scene, camera: bpy.types.Object) -> None:
    """Makes a camera the scene's, with its resolution and pixel aspect where it is one of the rig's."""
    scene.camera = camera
    render = scene.render
    render.pixel_aspect_x = render.pixel_aspect_y = 1.0
    if SIZE_KEY in camera:
        render.resolution_x, render.resolution_y = camera[SIZE_KEY]
        # Blender takes only ratios of 1 and more on either side.
        aspect = camera[ASPECT_KEY]
        render.pixel_aspect_x, render.pixel_aspect_y = max(1.0 / aspect, 1.0), max(aspect, 1.0)


def _matrix(base_from_optical: Pose, turn: np.ndarray) -> mathutils.Matrix:
    matrix = np.eye(4)
    matrix[:3, :3] = base_from_optical.rotation @ turn
    matrix[:3, 3] = base_from_optical.position_m
    return mathutils.Matrix(matrix.tolist())


def _new_outline(layers: Layers, base_link: bpy.types.Object, settings: Settings) -> bpy.types.Object:
    """The vehicle's own car, plain: where it is, and where ahead is."""
    size = (settings.ego_length_m, settings.ego_width_m, settings.ego_height_m)
    outline = layers.object("vehicle", to_blender("vehicle", shapes.vehicle(size)), "vehicle", base_link)
    outline.location = (settings.ego_center_x_m, 0.0, size[2] / 2.0)
    return outline
