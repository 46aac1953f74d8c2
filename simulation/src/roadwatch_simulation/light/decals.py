"""What is laid over the finished surfaces: contact shadows on the ground and the glow of lamps."""

from __future__ import annotations

from collections.abc import Sequence

import moderngl
import numpy as np

from ..model import Camera
from .buffers import Lamp
from .context import build_program, set_uniforms
from .drawlist import Drawable
from .lighting import Lighting
from .projection import matrix_bytes

# Light from the whole sky is kept from the ground this far around a vehicle, and around people.
VEHICLE_SPREAD_M = 0.55
PERSON_SPREAD_M = 0.30
# Cuboids at least this long are vehicles, with wheel arches and a floor that get little light.
VEHICLE_LENGTH_M = 2.5
# Shares of the picture's brightness taken away: below the object, and beside it without and with a sun.
BELOW_VEHICLE, BELOW_PERSON = 0.80, 0.50
BESIDE_OVERCAST, BESIDE_SUNNY = 0.55, 0.25
# Above the ground and its markings, below everything that stands on it.
LIFT_M = 0.018
GLOW_RADIUS_M = 0.42
GLOW_LEAST_PX = 3.0
GLOW_TOWARD_EYE_M = 0.12


class DecalPass:
    """Draws into the target that is in use, which holds the finished surfaces and their depth."""

    def __init__(self, context: moderngl.Context) -> None:
        self._context = context
        corners = context.buffer(np.array([-1, -1, 1, -1, -1, 1, 1, 1], dtype="<f4").tobytes())
        self._contact = build_program(context, "contact.vert", "contact.frag")
        self._contact_array = context.vertex_array(self._contact, [(corners, "2f", "in_corner")])
        self._glow = build_program(context, "glow.vert", "glow.frag")
        self._glow_array = context.vertex_array(self._glow, [(corners, "2f", "in_corner")])

    def contacts(self, items: Sequence[Drawable], clip_from_world: np.ndarray, lighting: Lighting) -> None:
        """Darkens the ground below and around objects."""
        self._context.enable_only(moderngl.DEPTH_TEST | moderngl.BLEND)
        self._context.blend_func = (moderngl.ZERO, moderngl.SRC_COLOR)
        self._context.polygon_offset = (-1.0, -2.0)
        self._context.fbo.depth_mask = False
        for item in items:
            if item.instance.object_id > 0:
                self._draw_contact(item, clip_from_world, lighting.is_sunny)
        self._context.polygon_offset = (0.0, 0.0)
        self._restore()

    def _draw_contact(self, item: Drawable, clip_from_world: np.ndarray, is_sunny: bool) -> None:
        length, width, _ = item.instance.model.size_lwh_m
        is_vehicle = length > VEHICLE_LENGTH_M
        pose = item.world_from_model
        values = {
            "clip_from_model": matrix_bytes(clip_from_world @ pose),
            "half_size": (length / 2.0, width / 2.0),
            "spread": VEHICLE_SPREAD_M if is_vehicle else PERSON_SPREAD_M,
            "below": BELOW_VEHICLE if is_vehicle else BELOW_PERSON,
            "beside": BESIDE_SUNNY if is_sunny else BESIDE_OVERCAST,
            "lift": LIFT_M,
        }
        set_uniforms(self._contact, values)
        self._contact_array.render(moderngl.TRIANGLE_STRIP)

    def glows(
        self, items: Sequence[Drawable], camera: Camera, clip_from_world: np.ndarray, lighting: Lighting
    ) -> None:
        """Lays a soft glow over lamps that are switched on and look at the camera."""
        if not lighting.lamps_on:
            return
        self._context.enable_only(moderngl.DEPTH_TEST | moderngl.BLEND)
        self._context.blend_func = (moderngl.ONE, moderngl.ONE_MINUS_SRC_COLOR)
        self._context.fbo.depth_mask = False
        for item in items:
            if item.instance.object_id > 0:
                for lamp in item.buffers.lamps:
                    self._draw_glow(item, lamp, camera, clip_from_world)
        self._restore()

    def _draw_glow(self, item: Drawable, lamp: Lamp, camera: Camera, clip_from_world: np.ndarray) -> None:
        pose = item.world_from_model
        place = pose[:3, :3] @ lamp.center_m + pose[:3, 3]
        to_eye = camera.world_from_camera[:3, 3] - place
        distance_m = max(float(np.linalg.norm(to_eye)), 1e-3)
        facing = float(to_eye @ (pose[:3, :3] @ lamp.direction)) / distance_m
        if facing <= 0.0:
            return
        radius = max(GLOW_RADIUS_M, GLOW_LEAST_PX * distance_m / camera.fx)
        values = {
            "clip_from_world": matrix_bytes(clip_from_world),
            "center": tuple(place + to_eye / distance_m * GLOW_TOWARD_EYE_M),
            "right": tuple(camera.world_from_camera[:3, 0] * radius),
            "up": tuple(camera.world_from_camera[:3, 1] * radius),
            "glow": tuple(np.asarray(lamp.colour) * facing**2),
        }
        set_uniforms(self._glow, values)
        self._glow_array.render(moderngl.TRIANGLE_STRIP)

    def _restore(self) -> None:
        self._context.fbo.depth_mask = True
        self._context.enable_only(moderngl.DEPTH_TEST)
