"""The colour pass: the picture itself, smoothed, from surfaces, sky and contact shadows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import cv2
import moderngl
import numpy as np

from ..model import Camera, Surface
from .buffers import FORMAT_FULL
from .context import build_program, set_uniforms
from .decals import VEHICLE_LENGTH_M, DecalPass
from .drawlist import Drawable
from .lighting import Lighting
from .mirror import MirrorTarget, mirror_matrix
from .noise import NOISE_SIZE_PX, noise_pixels
from .projection import clip_from_camera, matrix_bytes
from .shadows import ShadowMaps

NOISE_UNIT, SHADOW_UNIT, MATERIAL_UNIT, MIRROR_UNIT = 0, 1, 2, 3
# Matt by nature: mirrored surroundings would not show on them.
MATT = (Surface.GRASS, Surface.PLASTER, Surface.BRICK, Surface.FOLIAGE, Surface.CLOTH)
GROUND = (Surface.ASPHALT, Surface.PAVING, Surface.PLAIN)


@dataclass
class _View:
    """What all surfaces of one drawing share; `prepared` holds the programs that know it already."""

    clip_from_world: np.ndarray
    lighting: Lighting
    shared: dict[str, object]
    is_wet: bool
    prepared: set[int] = field(default_factory=set)


class ColourPass:
    """Draws what the camera would see, before its lens and sensor.

    The picture is drawn `supersampling` times wider and higher and averaged: Mesa's software driver takes
    more time for multisampling than for all these pixels, and averaging also calms highlights.
    """

    def __init__(
        self, context: moderngl.Context, width_px: int, height_px: int, supersampling: float
    ) -> None:
        self._context = context
        self._size = (width_px, height_px)
        self._drawn_size = (round(width_px * supersampling), round(height_px * supersampling))
        self._target = context.framebuffer(
            [context.renderbuffer(self._drawn_size, 4)], context.depth_renderbuffer(self._drawn_size)
        )
        self._noise = context.texture((NOISE_SIZE_PX, NOISE_SIZE_PX), 4, noise_pixels())
        self._noise.build_mipmaps()
        self._noise.filter = (moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR)
        self._decals = DecalPass(context)
        self._sky = build_program(context, "sky.vert", "sky.frag")
        corners = context.buffer(np.array([-1, -1, 3, -1, -1, 3], dtype="<f4").tobytes())
        self._sky_array = context.vertex_array(self._sky, [(corners, "2f", "in_corner")])
        self._mirror = MirrorTarget(context, width_px, height_px)
        self._programs: dict[tuple[tuple[str, int], ...], moderngl.Program] = {}

    def draw(
        self,
        items: Sequence[Drawable],
        camera: Camera,
        clip_from_world: np.ndarray,
        lighting: Lighting,
        shadows: ShadowMaps,
        ground_z_m: float = 0.0,
    ) -> np.ndarray:
        """The picture, uint8 BGR (h, w, 3)."""
        self._context.enable_only(moderngl.DEPTH_TEST)
        self._context.depth_func = "<="
        self._noise.use(NOISE_UNIT)
        shadows.texture.use(SHADOW_UNIT)
        shared = self._shared_uniforms(camera, lighting, shadows)
        if lighting.is_wet:
            self._draw_mirrored(items, clip_from_world, lighting, shared, ground_z_m)
        self._target.use()
        self._target.clear()
        view = _View(clip_from_world, lighting, shared, lighting.is_wet)
        for item in items:
            self._draw_item(item, view)
        self._decals.contacts(items, clip_from_world, lighting)
        self._draw_sky(camera, lighting)
        self._decals.glows(items, camera, clip_from_world, lighting)
        width, height = self._drawn_size
        raw = np.frombuffer(self._target.read(components=4, alignment=1), dtype=np.uint8)
        image = cv2.cvtColor(raw.reshape(height, width, 4), cv2.COLOR_RGBA2BGR)
        return cv2.resize(image, self._size, interpolation=cv2.INTER_AREA)

    def _shared_uniforms(self, camera: Camera, lighting: Lighting, shadows: ShadowMaps) -> dict[str, object]:
        return {
            **lighting.uniforms,
            **shadows.uniforms(),
            "eye": tuple(camera.world_from_camera[:3, 3]),
            "pixel_angle": self._size[0] / (camera.fx * self._drawn_size[0]),
            "is_mirrored": False,
            "noise": NOISE_UNIT,
            "shadow_map": SHADOW_UNIT,
            "materials": MATERIAL_UNIT,
        }

    def _draw_mirrored(
        self,
        items: Sequence[Drawable],
        clip_from_world: np.ndarray,
        lighting: Lighting,
        shared: dict[str, object],
        ground_z_m: float,
    ) -> None:
        """Fills the mirror's texture with what wet ground shows upside down."""
        world_from_mirrored = mirror_matrix(ground_z_m)
        eye = world_from_mirrored @ np.array([*shared["eye"], 1.0])
        seen_from_below = {**shared, "eye": tuple(eye[:3]), "is_mirrored": True}
        with self._mirror.drawing(self._context):
            view = _View(clip_from_world @ world_from_mirrored, lighting, seen_from_below, False)
            for item in items:
                self._draw_item(item, view)
        self._mirror.texture.use(MIRROR_UNIT)
        shared.update(mirrored=MIRROR_UNIT, drawn_size_px=self._drawn_size)

    def _program(self, surface: Surface, is_sunny: bool, is_wet: bool) -> moderngl.Program:
        defines = (
            ("SURFACE", int(surface)),
            ("SUNNY", int(is_sunny)),
            ("WET", int(is_wet)),
            ("GLOSSY", int(is_wet or surface not in MATT)),
        )
        if defines not in self._programs:
            self._programs[defines] = build_program(self._context, "surface.vert", "surface.frag", defines)
        return self._programs[defines]

    def _draw_item(self, item: Drawable, view: _View) -> None:
        pose = item.world_from_model
        is_scenery = item.instance.object_id == 0
        length, width, height = item.instance.model.size_lwh_m
        is_vehicle = not is_scenery and length > VEHICLE_LENGTH_M
        own = {
            "clip_from_model": matrix_bytes(view.clip_from_world @ pose),
            "world_from_model": matrix_bytes(pose),
            "foot_z": float(pose[2, 3]),
            "body": (length / 2.0, width / 2.0, height) if is_vehicle else (0.0, 0.0, 0.0),
        }
        item.buffers.materials.use(MATERIAL_UNIT)
        for run in item.buffers.ranges:
            is_wet = view.is_wet and is_scenery and run.surface in GROUND
            program = self._program(run.surface, view.lighting.is_sunny, is_wet)
            if program.glo not in view.prepared:
                set_uniforms(program, view.shared)
                view.prepared.add(program.glo)
            set_uniforms(program, own)
            array = item.buffers.array(self._context, program, FORMAT_FULL)
            array.render(vertices=run.count, first=run.first)

    def _draw_sky(self, camera: Camera, lighting: Lighting) -> None:
        projection = clip_from_camera(camera)
        camera_from_corner = np.linalg.inv(projection[np.ix_([0, 1, 3], [0, 1, 2])])
        world_from_corner = camera.world_from_camera[:3, :3] @ camera_from_corner
        set_uniforms(self._sky, {**lighting.uniforms, "noise": NOISE_UNIT})
        self._sky["world_from_corner"].write(matrix_bytes(world_from_corner))
        self._sky_array.render()
