"""Draws one camera's picture of one frame, with truth, whichever renderer does it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from . import imaging
from .errors import SimulationError
from .model import Camera, Instance, Light, Rendered
from .rig import CameraMount
from .scene import Scene
from .truth import object_truth

RENDERERS = ("light", "blender")


class Renderer(Protocol):
    """What draws pictures of one size."""

    def render(self, instances: Sequence[Instance], camera: Camera, light: Light) -> Rendered:
        """The picture, and what every pixel shows."""


@dataclass(frozen=True)
class Capture:
    """One picture: a JPEG file's bytes, the picture before compression, and the truth of what is in it."""

    jpeg: bytes
    image_bgr: np.ndarray
    objects: list[dict]


class Studio:
    """Keeps one renderer per image size."""

    def __init__(self, renderer: str = "light") -> None:
        if renderer not in RENDERERS:
            raise SimulationError(f"renderer `{renderer}` does not exist; there are {', '.join(RENDERERS)}")
        self._kind = renderer
        self._renderers: dict[tuple[int, int], Renderer] = {}

    def capture(
        self, scene: Scene, frame: int, camera_index: int, jpeg_quality: int | None = None
    ) -> Capture:
        """What a camera of the scene delivers at a frame; the same for the same arguments."""
        mount = scene.cameras[camera_index]
        world_from_base, objects = scene.at_camera(frame, mount)
        camera = mount.camera(world_from_base)
        rendered = self._renderer(mount).render([*scene.place.instances, *objects], camera, scene.light)
        rng = np.random.default_rng([scene.seed, 7, frame, camera_index])
        image = imaging.apply(rendered.image_bgr, scene.imaging, rng)
        truth = object_truth(objects, camera, rendered, np.linalg.inv(world_from_base), scene.moving_ids())
        return Capture(imaging.encode_jpeg(image, jpeg_quality or scene.imaging.jpeg_quality), image, truth)

    def _renderer(self, mount: CameraMount) -> Renderer:
        size = (mount.width_px, mount.height_px)
        if size not in self._renderers:
            self._renderers[size] = self._make(*size)
        return self._renderers[size]

    def _make(self, width_px: int, height_px: int) -> Renderer:
        if self._kind == "light":
            from .light import LightRenderer

            return LightRenderer(width_px, height_px)
        from .blender import BlenderRenderer

        return BlenderRenderer(width_px, height_px)
