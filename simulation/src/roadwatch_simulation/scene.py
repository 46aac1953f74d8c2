"""One scene: where it plays, what moves in it, and which cameras look at it, at every frame."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from . import catalogue
from .imaging import Imaging
from .model import Camera, Instance, Light, Model
from .motion import GroundPose, Path, standing
from .rig import CameraMount
from .scenery import Footprint, Place, build_place
from .scenery.builder import pose

FIRST_STAMP_NS = 1_700_000_000_000_000_000
"""Stamp of the first frame: a round moment in the past, since a simulated world has no date of its own."""
LIGHT_KINDS = ("sun", "overcast", "dusk", "wet")


@dataclass(frozen=True)
class Environment:
    """Where a scene plays and in which light. The sun's angles say where it stands, in world axes."""

    kind: str = "street"
    seed: int = 0
    light: str = "sun"
    sun_azimuth_deg: float = -50.0
    sun_elevation_deg: float = 42.0

    def lighting(self) -> Light:
        """The light for the renderers."""
        elevation = min(self.sun_elevation_deg, 9.0) if self.light == "dusk" else self.sun_elevation_deg
        azimuth, elevation = math.radians(self.sun_azimuth_deg), math.radians(elevation)
        level = math.cos(elevation)
        direction = (level * math.cos(azimuth), level * math.sin(azimuth), math.sin(elevation))
        varied = {
            "sun": {},
            "overcast": {"sun": 0.0, "sky": 0.95, "haze_per_m": 0.0014},
            "dusk": {"sun": 1.1, "sky": 0.45, "warmth": 0.9, "headlights": True},
            "wet": {"sun": 0.0, "sky": 0.75, "haze_per_m": 0.0028, "wetness": 0.85, "headlights": True},
        }[self.light]
        return Light(direction, seed=self.seed, **varied)


@dataclass(frozen=True)
class SceneObject:
    """A thing with truth: one of the catalogue's kinds, by its seed, on a path. Its name is for messages."""

    name: str
    kind: str
    seed: int
    path: Path
    size_lwh_m: tuple[float, float, float] | None = None
    colour: tuple[float, float, float] | None = None

    @cached_property
    def model(self) -> Model:
        """What it looks like."""
        return catalogue.build(self.kind, self.seed, size_lwh_m=self.size_lwh_m, colour=self.colour)

    def footprint(self, time_s: float) -> Footprint:
        """The rectangle under it at a time."""
        at = self.path.at(time_s)
        length, width, _ = self.model.size_lwh_m
        return Footprint(at.x_m, at.y_m, at.yaw_rad, length, width)


@dataclass(frozen=True)
class Scene:
    """Everything that two renderers need to draw the same pictures. Times count from frame 0."""

    frames: int
    rate_hz: float
    cameras: tuple[CameraMount, ...]
    objects: tuple[SceneObject, ...]
    seed: int = 0
    environment: Environment = field(default_factory=Environment)
    imaging: Imaging = field(default_factory=Imaging)
    ego: Path = field(default_factory=lambda: standing(0.0, 0.0, 0.0))
    light_override: Light | None = None

    @property
    def place(self) -> Place:
        """The scenery and its layout."""
        return build_place(self.environment.kind, self.environment.seed)

    @property
    def light(self) -> Light:
        """The light of the whole scene."""
        return self.light_override or self.environment.lighting()

    def time_s(self, frame: int) -> float:
        """When a frame is, from frame 0."""
        return frame / self.rate_hz

    def stamp_ns(self, frame: int, camera: CameraMount | None = None) -> int:
        """When a camera captured a frame, or the frame's own moment, nanoseconds since 1970."""
        period_ns = round(frame * 1_000_000_000 / self.rate_hz)
        delay_ns = round(camera.delay_s * 1_000_000_000) if camera else 0
        return FIRST_STAMP_NS + period_ns + delay_ns

    def at(self, frame: int) -> tuple[np.ndarray, list[Instance]]:
        """`world_from_base` and everything with truth, at a frame's own moment."""
        return self.at_time(self.time_s(frame))

    def at_camera(self, frame: int, camera: CameraMount) -> tuple[np.ndarray, list[Instance]]:
        """The same at the moment when a camera captures that frame."""
        return self.at_time(self.time_s(frame) + camera.delay_s)

    def at_time(self, time_s: float) -> tuple[np.ndarray, list[Instance]]:
        """The same at any time."""
        instances = [
            Instance(thing.model, self._standing(thing.path.at(time_s)), index)
            for index, thing in enumerate(self.objects, start=1)
        ]
        ego = self.ego.at(time_s)
        return pose(ego.x_m, ego.y_m, ego.yaw_rad), instances

    def camera_at(self, frame: int, camera: CameraMount) -> Camera:
        """A camera in the world when it captures a frame."""
        ego = self.ego.at(self.time_s(frame) + camera.delay_s)
        return camera.camera(pose(ego.x_m, ego.y_m, ego.yaw_rad))

    def moving_ids(self) -> frozenset[int]:
        """Object ids of what moves at any time."""
        return frozenset(index for index, thing in enumerate(self.objects, start=1) if thing.path.is_moving)

    def _standing(self, at: GroundPose) -> np.ndarray:
        height = self.place.layout.height_m(at.x_m, at.y_m)
        return pose(at.x_m, at.y_m, at.yaw_rad, height)
