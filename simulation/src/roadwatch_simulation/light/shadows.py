"""The sun's shadow maps: one for what is near the camera, one for the rest of the street, side by side."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import moderngl
import numpy as np

from ..model import Camera, Surface
from .buffers import FORMAT_POSITION
from .context import build_program
from .drawlist import Drawable, seen
from .projection import CASCADES, frustum_planes, matrix_bytes, shadow_clip_from_world

SHADOW_SIZE_PX = 2048


@dataclass(frozen=True)
class ShadowMaps:
    """The filled maps and how to find a place in each."""

    texture: moderngl.Texture
    clip_from_world: tuple[np.ndarray, ...]

    def uniforms(self) -> dict[str, object]:
        """What the surface shader needs to look a place up."""
        near, far = self.clip_from_world
        # A clip volume is 2 wide, so a unit of clip space is this many metres.
        metres = [2.0 / SHADOW_SIZE_PX / np.linalg.norm(matrix[0, :3]) for matrix in (near, far)]
        return {
            "near_from_world": matrix_bytes(near),
            "far_from_world": matrix_bytes(far),
            "shadow_texel_m": (float(metres[0]), float(metres[1])),
            "shadow_texel": 1.0 / SHADOW_SIZE_PX,
        }


class ShadowPass:
    """Depth as the sun sees it."""

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        self._texture = context.depth_texture((SHADOW_SIZE_PX * len(CASCADES), SHADOW_SIZE_PX))
        self._texture.compare_func = "<="
        self._texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
        self._texture.repeat_x = self._texture.repeat_y = False
        self._target = context.framebuffer(depth_attachment=self._texture)
        self._programs = {
            cut: build_program(context, "shape.vert", "shadow.frag", (("MASK", 1), ("CUTOUT", int(cut))))
            for cut in (False, True)
        }

    def skip(self) -> ShadowMaps:
        """Maps that nobody looks into, for light without a sun."""
        return ShadowMaps(self._texture, (np.eye(4), np.eye(4)))

    def draw(
        self, items: Sequence[Drawable], camera: Camera, sun_direction: np.ndarray, ground_z_m: float
    ) -> ShadowMaps:
        """Fills the maps with everything that can throw a shadow into the camera's view."""
        self._target.use()
        self._target.clear()
        self._context.enable_only(moderngl.DEPTH_TEST)
        matrices = []
        for index, cascade in enumerate(CASCADES):
            matrix = shadow_clip_from_world(camera, cascade, sun_direction, ground_z_m)
            self._target.viewport = (index * SHADOW_SIZE_PX, 0, SHADOW_SIZE_PX, SHADOW_SIZE_PX)
            for item in seen(items, frustum_planes(matrix)):
                self._draw_item(item, matrix)
            matrices.append(matrix)
        self._target.viewport = (0, 0, SHADOW_SIZE_PX * len(CASCADES), SHADOW_SIZE_PX)
        return ShadowMaps(self._texture, tuple(matrices))

    def _draw_item(self, item: Drawable, clip_from_world: np.ndarray) -> None:
        clip_from_model = matrix_bytes(clip_from_world @ item.world_from_model)
        for run in item.buffers.ranges:
            program = self._programs[run.surface is Surface.FOLIAGE]
            program["clip_from_model"].write(clip_from_model)
            array = item.buffers.array(self._context, program, FORMAT_POSITION)
            array.render(vertices=run.count, first=run.first)
