"""Our meshes, instances and camera in Blender's scene."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import mathutils
import numpy as np

from ..light.buffers import distinct_materials
from ..model import Camera, Instance, Material, Model
from .nodes import Conditions, build_material

SENSOR_WIDTH_MM = 36.0
CLIP_START_M, CLIP_END_M = 0.05, 3000.0
# Blender's cameras look along their -z and have y up; optical axes have z forward and y down.
OPTICAL_FROM_BLENDER = np.diag([1.0, -1.0, -1.0, 1.0])


class Stage:
    """The scene's things. Meshes are kept between pictures, objects are set up anew for each."""

    def __init__(self, scene: bpy.types.Scene) -> None:
        self._scene = scene
        self._materials: dict[Material, bpy.types.Material] = {}
        self._meshes: dict[int, tuple[Model, bpy.types.Mesh]] = {}
        self._conditions: Conditions | None = None
        self._objects: list[bpy.types.Object] = []

    def set_instances(self, instances: Sequence[Instance], conditions: Conditions) -> None:
        """Puts exactly these instances on the stage."""
        for old in self._objects:
            bpy.data.objects.remove(old)
        self._objects = []
        self._forget_unused(instances, conditions)
        for instance in instances:
            if len(instance.model.mesh.positions):
                made = bpy.data.objects.new(instance.model.label, self._mesh(instance.model))
                pose = np.asarray(instance.world_from_model, dtype=float)
                made.matrix_world = mathutils.Matrix(pose.tolist())
                self._scene.collection.objects.link(made)
                self._objects.append(made)

    def _forget_unused(self, instances: Sequence[Instance], conditions: Conditions) -> None:
        """Drops meshes of models that are gone, and everything when materials look different now."""
        wanted = {id(instance.model) for instance in instances}
        if conditions != self._conditions:
            self._conditions = conditions
            wanted = set()
        for key in [key for key in self._meshes if key not in wanted]:
            _, mesh = self._meshes.pop(key)
            bpy.data.meshes.remove(mesh)
        if not wanted:
            for material in self._materials.values():
                bpy.data.materials.remove(material)
            self._materials.clear()

    def _mesh(self, model: Model) -> bpy.types.Mesh:
        key = id(model)
        if key not in self._meshes:
            distinct, chosen = distinct_materials(model)
            mesh = build_mesh(model, chosen)
            for material in distinct:
                mesh.materials.append(self._material(material))
            self._meshes[key] = (model, mesh)
        return self._meshes[key][1]

    def _material(self, material: Material) -> bpy.types.Material:
        if material not in self._materials:
            self._materials[material] = build_material(material, self._conditions)
        return self._materials[material]


def build_mesh(model: Model, material_of_triangle: np.ndarray) -> bpy.types.Mesh:
    """The model's triangles with their own corner normals; `material_of_triangle` is int32 (n,)."""
    arrays = model.mesh
    count = len(arrays.positions)
    mesh = bpy.data.meshes.new(model.label)
    mesh.vertices.add(3 * count)
    mesh.vertices.foreach_set("co", np.ascontiguousarray(arrays.positions, dtype=np.float32).ravel())
    mesh.loops.add(3 * count)
    mesh.loops.foreach_set("vertex_index", np.arange(3 * count, dtype=np.int32))
    mesh.polygons.add(count)
    mesh.polygons.foreach_set("loop_start", np.arange(0, 3 * count, 3, dtype=np.int32))
    mesh.polygons.foreach_set("material_index", np.ascontiguousarray(material_of_triangle, dtype=np.int32))
    mesh.polygons.foreach_set("use_smooth", np.ones(count, dtype=bool))
    mesh.update(calc_edges=True)
    mesh.normals_split_custom_set(arrays.normals.reshape(-1, 3).astype(float).tolist())
    return mesh


def set_camera(scene: bpy.types.Scene, camera: Camera) -> None:
    """Makes the scene's camera see what ours does, to the pixel, off-centre principal points included."""
    if scene.camera is None:
        scene.camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
        scene.collection.objects.link(scene.camera)
    aspect = camera.fx / camera.fy
    render = scene.render
    render.resolution_x, render.resolution_y = camera.width_px, camera.height_px
    render.resolution_percentage = 100
    # Blender takes only ratios of 1 and more on either side.
    render.pixel_aspect_x, render.pixel_aspect_y = max(1.0 / aspect, 1.0), max(aspect, 1.0)
    lens = scene.camera.data
    lens.sensor_fit = "HORIZONTAL"
    lens.sensor_width = SENSOR_WIDTH_MM
    lens.lens = camera.fx * SENSOR_WIDTH_MM / camera.width_px
    lens.shift_x = -(camera.cx + 0.5 - camera.width_px / 2.0) / camera.width_px
    lens.shift_y = (camera.cy + 0.5 - camera.height_px / 2.0) / camera.width_px * aspect
    lens.clip_start, lens.clip_end = CLIP_START_M, CLIP_END_M
    pose = np.asarray(camera.world_from_camera, dtype=float) @ OPTICAL_FROM_BLENDER
    scene.camera.matrix_world = mathutils.Matrix(pose.tolist())
