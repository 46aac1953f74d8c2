"""A place, the rig's own way through it, and things on planned ways, tried until all that matters fits."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ..errors import SimulationError
from ..motion import Path, standing
from ..rig import CameraMount
from ..scene import Environment, Scene
from ..scenery import Footprint, build_place
from ..traffic import EGO_SIZE_M, STEP_S, Look, TrafficPlan
from .drive import CLEAN_IMAGING, six_cameras

RATE_HZ = 10.0
FRAMES = 80
BEYOND_S = 0.2
"""Cameras fire after the last frame's moment."""
PLACES_TRIED = 2000
ATTEMPTS = 80
CAR_KINDS = ("sedan", "compact", "suv", "wagon", "minivan", "pickup", "van")


class Misfit(Exception):
    """What a scenario promises does not fit into this place."""


@dataclass
class Stage:
    """What there is of a scene while things are put into it."""

    environment: Environment
    rng: np.random.Generator
    plan: TrafficPlan

    def put(self, look: Look, path: Path) -> None:
        """Adds a thing. Raises Misfit where it would touch another, or what stands beside the road."""
        if not self.plan.propose(look, path):
            raise Misfit

    def put_car(self, path: Path) -> None:
        """The same with any car."""
        self.put(self.look(*CAR_KINDS), path)

    def park(self, share: float, x_m: tuple[float, float], within_m: float = math.inf) -> None:
        """Cars in a share of the bays between two x, and so near to the origin; those that fit."""
        for bay in self.plan.place.layout.bays:
            near = x_m[0] < bay.x_m < x_m[1] and math.hypot(bay.x_m, bay.y_m) < within_m
            if near and self.rng.random() < share:
                yaw = bay.yaw_rad + float(self.rng.normal(0.0, 0.02))
                self.plan.propose(self.look(*CAR_KINDS), standing(bay.x_m, bay.y_m, yaw))

    def look(self, *kinds: str) -> Look:
        """Anything of these kinds."""
        return Look(str(self.rng.choice(kinds)), int(self.rng.integers(1 << 30)))

    def keep_to_the_road(self) -> None:
        """Raises Misfit where the rig's own vehicle would leave the road or touch what stands beside it."""
        layout = self.plan.place.layout
        for moment in np.arange(0.0, self.plan.duration_s, STEP_S):
            at = self.plan.ego.at(float(moment))
            body = Footprint(at.x_m, at.y_m, at.yaw_rad, *EGO_SIZE_M)
            if not all(layout.is_road(*corner) for corner in body.corners().tolist()):
                raise Misfit
            if any(body.overlaps(obstacle) for obstacle in layout.obstacles):
                raise Misfit


def set_up(kind: str, place_seed: int, rng: np.random.Generator, ego: Path, duration_s: float) -> Stage:
    """A place by day with the rig's own vehicle in it. Raises Misfit where that would leave the road."""
    environment = Environment(
        kind, place_seed, str(rng.choice(["sun", "sun", "overcast"])),
        sun_azimuth_deg=round(float(rng.uniform(-180, 180)), 1),
        sun_elevation_deg=round(float(rng.uniform(28, 60)), 1),
    )  # fmt: skip
    stage = Stage(environment, rng, TrafficPlan(build_place(kind, place_seed), ego, duration_s))
    stage.keep_to_the_road()
    return stage


def staged(
    build: Callable[[np.random.Generator, float], Stage], seed: int, frames: int, *, least: int = FRAMES,
    at_once: bool = False,
) -> Scene:
    """The first stage that holds all that the scenario promises.

    Ways are planned for `least` frames, so that a short run is the beginning of a longer one. With `at_once`
    the cameras fire together, otherwise one after another.
    """
    duration_s = max(frames, least) / RATE_HZ + BEYOND_S
    for attempt in range(ATTEMPTS):
        try:
            stage = build(np.random.default_rng([seed, 71, attempt]), duration_s)
        except Misfit:
            continue
        return Scene(
            frames=frames, rate_hz=RATE_HZ, cameras=_together() if at_once else six_cameras(),
            objects=tuple(stage.plan.objects), seed=seed, environment=stage.environment,
            imaging=CLEAN_IMAGING, ego=stage.plan.ego,
        )  # fmt: skip
    raise SimulationError(f"no place fits this scenario with seed {seed}; take another seed")


def seed_where(fits: Callable[[int], bool], rng: np.random.Generator) -> int:
    """A place's seed that fits. Raises Misfit when there is none among many."""
    for _ in range(PLACES_TRIED):
        seed = int(rng.integers(1 << 30))
        if fits(seed):
            return seed
    raise Misfit


def _together() -> tuple[CameraMount, ...]:
    return tuple(replace(camera, delay_s=0.0) for camera in six_cameras())
