"""Cycles pictures with the light renderer's ids: the same instances, camera and light, a better look."""

from __future__ import annotations

import dataclasses
import math
import os
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import bpy
import cv2
import numpy as np

from ..errors import SimulationError
from ..light import LightRenderer
from ..light.lighting import lighting_of
from ..model import Camera, Instance, Light, Rendered
from .nodes import Conditions
from .sky import set_sky
from .stage import Stage, set_camera

# Between the exposures that both renderers' curves want for the same light, in stops.
EXPOSURE_OFFSET_EV = 0.7
DIFFUSE_BOUNCES = 2
GLOSSY_BOUNCES = 2
MOST_BOUNCES = 4


class BlenderRenderer:
    """Draws pictures of one size with Cycles on the CPU.

    There is one Blender in a process, so make one of these at a time. Ids and silhouettes are the light
    renderer's: they do not know of what Cycles adds (depth of field is off, so edges agree to a pixel).
    """

    def __init__(self, width_px: int, height_px: int, samples: int = 8) -> None:
        self._ids = LightRenderer(width_px, height_px)
        bpy.ops.wm.read_factory_settings(use_empty=True)
        self._scene = bpy.context.scene
        _set_cycles(self._scene, samples)
        self._stage = Stage(self._scene)

    def render(self, instances: Sequence[Instance], camera: Camera, light: Light) -> Rendered:
        """The picture of `instances` from `camera`."""
        identified = self._ids.render(instances, camera, light)
        lighting = lighting_of(light)
        self._stage.set_instances(instances, Conditions(lighting.lamps_on, light.wetness))
        set_camera(self._scene, camera)
        set_sky(self._scene, lighting)
        exposure = float(lighting.uniforms["exposure"])
        self._scene.view_settings.exposure = math.log2(exposure) + EXPOSURE_OFFSET_EV
        image = _picture(self._scene)
        return dataclasses.replace(identified, image_bgr=image)

    def close(self) -> None:
        """Gives the light renderer's context back."""
        self._ids.close()


def _set_cycles(scene: bpy.types.Scene, samples: int) -> None:
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.samples = samples
    cycles.seed = 0
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = True
    cycles.denoiser = "OPENIMAGEDENOISE"
    cycles.denoising_input_passes = "RGB_ALBEDO_NORMAL"
    cycles.max_bounces = MOST_BOUNCES
    cycles.diffuse_bounces, cycles.glossy_bounces = DIFFUSE_BOUNCES, GLOSSY_BOUNCES
    cycles.caustics_reflective = cycles.caustics_refractive = False
    scene.render.threads_mode = "FIXED"
    scene.render.threads = os.cpu_count() or 1
    scene.render.use_persistent_data = True
    scene.view_settings.view_transform = "AgX"
    scene.view_settings.look = "AgX - Medium High Contrast"
    scene.render.image_settings.file_format = "PNG"


@contextmanager
def _silence() -> Iterator[None]:
    """Keeps Blender's progress, which its C++ side writes past Python's sys.stdout, off the terminal."""
    sys.stdout.flush()
    kept = os.dup(1)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 1)
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)
        os.close(nowhere)


def _picture(scene: bpy.types.Scene) -> np.ndarray:
    """Renders and reads the developed picture back, uint8 BGR (h, w, 3)."""
    with tempfile.TemporaryDirectory() as folder:
        scene.render.filepath = str(Path(folder) / "picture.png")
        with _silence():
            bpy.ops.render.render(write_still=True)
        image = cv2.imread(scene.render.filepath, cv2.IMREAD_COLOR)
    if image is None:
        raise SimulationError(f"Blender wrote no picture to {scene.render.filepath}; is the disk full?")
    return image
