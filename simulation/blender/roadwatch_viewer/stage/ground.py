"""The ground: a level square with a grid that follows the vehicle by whole squares."""

from __future__ import annotations

import bpy
import numpy as np

from .. import shapes
from .keyframes import Recorder
from .layers import Layers
from .meshes import to_blender

STEP_M = 10.0
GRID_HALF_M = 200.0
GROUND_HALF_M = 1500.0
BELOW_M = 0.03
"""The square lies this far below the grid, for the depth buffer."""


class Ground:
    """Level ground at the vehicle's height."""

    def __init__(self, layers: Layers) -> None:
        grid = to_blender("grid", shapes.grid(GRID_HALF_M, STEP_M))
        square = to_blender("ground", shapes.ground(GROUND_HALF_M))
        self.grid = layers.object("grid", grid, "ground")
        self.square = layers.object("ground", square, "ground", self.grid)
        self.square.location.z = -BELOW_M

    def follow(self, base_m: np.ndarray, recorder: Recorder | None) -> None:
        """Moves under the vehicle, `base_m` in Blender's world."""
        x, y = (np.round(base_m[:2] / STEP_M) * STEP_M).tolist()
        location = (x, y, float(base_m[2]))
        self.grid.location = location
        if recorder is not None:
            recorder.note_step(self.grid, "location", location)

    def set_visible(self, is_visible: bool) -> None:
        """Whether pictures show it."""
        for each in (self.grid, self.square):
            each.hide_render = not is_visible


def add_sun(scene: bpy.types.Scene, layers: Layers) -> None:
    """Light for EEVEE and Cycles; Workbench brings its own."""
    lamp = bpy.data.lights.new("sun", "SUN")
    lamp.energy, lamp.angle = 3.0, 0.05
    sun = layers.object("sun", lamp, "ground")
    sun.rotation_euler = (0.6, 0.25, 0.4)
    if scene.world is None:
        scene.world = bpy.data.worlds.new("Roadwatch sky")
    scene.world.use_nodes = True
    background = scene.world.node_tree.nodes.get("Background")
    if background is not None:
        background.inputs["Color"].default_value = (0.72, 0.80, 0.92, 1.0)
        background.inputs["Strength"].default_value = 0.7
