"""What wet ground mirrors: the scene upside down, drawn before the picture and read by its ground."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import moderngl
import numpy as np

# OpenGL's own number for the first user clip plane, which moderngl does not name.
CLIP_DISTANCE_0 = 0x3000


def mirror_matrix(ground_z_m: float) -> np.ndarray:
    """From a place to its mirror image in level ground."""
    matrix = np.diag([1.0, 1.0, -1.0, 1.0])
    matrix[2, 3] = 2.0 * ground_z_m
    return matrix


class MirrorTarget:
    """A picture of half the drawn size; alpha is 0 where nothing but sky is mirrored."""

    def __init__(self, context: moderngl.Context, width_px: int, height_px: int) -> None:
        size = (width_px, height_px)
        self.texture = context.texture(size, 4)
        self.texture.filter = (moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR)
        self.texture.repeat_x = self.texture.repeat_y = False
        self._target = context.framebuffer([self.texture], context.depth_renderbuffer(size))

    @contextmanager
    def drawing(self, context: moderngl.Context) -> Iterator[None]:
        """Draws within go into the mirror; what lies below the ground is cut off."""
        self._target.use()
        self._target.clear()
        context.enable_direct(CLIP_DISTANCE_0)
        try:
            yield
        finally:
            context.disable_direct(CLIP_DISTANCE_0)
            self.texture.build_mipmaps()
