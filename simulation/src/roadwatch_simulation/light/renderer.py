"""The light renderer itself: one picture with what every pixel shows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..errors import SimulationError
from ..model import Camera, Instance, Light, Rendered
from .buffers import BufferCache
from .colour import ColourPass
from .context import open_context
from .drawlist import Drawable, drawables, nearest_first, seen
from .identity import IdentityPass
from .lighting import lighting_of
from .projection import clip_from_world, frustum_planes
from .shadows import ShadowPass


# Edges at 1.5 are rough enough to cost a detector several cars in a hundred, for a quarter less time.
SUPERSAMPLING = 2.0


class LightRenderer:
    """Draws pictures of one size.

    The same instances, camera and light give the same bytes on the same machine. Models are kept on the
    graphics side by identity, so hand over the same Model objects again rather than equal ones.
    `supersampling` is how many pixels are drawn for one, along each side.
    """

    def __init__(self, width_px: int, height_px: int, supersampling: float = SUPERSAMPLING) -> None:
        self.width_px = width_px
        self.height_px = height_px
        self._context = open_context()
        self._cache = BufferCache(self._context)
        self._shadows = ShadowPass(self._context)
        self._colour = ColourPass(self._context, width_px, height_px, supersampling)
        self._identity = IdentityPass(self._context, width_px, height_px)

    def render(self, instances: Sequence[Instance], camera: Camera, light: Light) -> Rendered:
        """The picture of `instances` from `camera`; a camera of another size raises SimulationError."""
        if (camera.width_px, camera.height_px) != (self.width_px, self.height_px):
            raise SimulationError(
                f"the renderer was made for {self.width_px}x{self.height_px} px and got a camera of "
                f"{camera.width_px}x{camera.height_px} px; make one renderer per image size"
            )
        with self._context:
            return self._render(instances, camera, light)

    def _render(self, instances: Sequence[Instance], camera: Camera, light: Light) -> Rendered:
        everything = drawables(instances, self._cache)
        clip = clip_from_world(camera)
        visible = nearest_first(seen(everything, frustum_planes(clip)), camera.world_from_camera[:3, 3])
        lighting = lighting_of(light)
        ground_z_m = _ground_z_m(everything)
        shadows = self._shadows.skip()
        if lighting.is_sunny:
            shadows = self._shadows.draw(everything, camera, lighting.sun_direction, ground_z_m)
        image = self._colour.draw(visible, camera, clip, lighting, shadows, ground_z_m)
        object_ids, part_ids = self._identity.draw(visible, clip)
        silhouettes = self._identity.silhouettes(visible, clip)
        self._cache.trim()
        return Rendered(image, object_ids, part_ids, silhouettes)

    def close(self) -> None:
        """Gives the graphics context back."""
        self._context.release()


def _ground_z_m(items: Sequence[Drawable]) -> float:
    """Height of the ground, taken from the feet of the objects."""
    feet = [float(item.world_from_model[2, 3]) for item in items if item.instance.object_id > 0]
    return float(np.median(feet)) if feet else 0.0
