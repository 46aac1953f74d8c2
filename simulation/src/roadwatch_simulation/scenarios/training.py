"""Random single pictures for training a detector: any place, light, camera and crowd."""

from __future__ import annotations

import math

import numpy as np

from ..imaging import Imaging
from ..model import Light
from ..motion import standing
from ..rig import CameraMount, mount
from ..scene import Environment, Scene
from ..scenery import Footprint, Lane, Layout, Place, build_place
from .crowd import VEHICLE_SHARES, Crowd, Wardrobe, draw_wardrobe

IMAGE_SIZE_PX = (960, 540)
PICTURES_PER_PLACE = 6
"""Pictures in a row that share one place: building it takes as long as drawing one."""
PICTURES_PER_WARDROBE = 24
"""Pictures in a row that share one set of models, for the same reason."""
REACH_M = 60.0
ENVIRONMENT_SHARES = {"street": 0.46, "junction": 0.30, "car_park": 0.20, "plain": 0.04}
VIEWS_DEG = (0.0, 0.0, 0.0, 180.0, 60.0, -60.0, 90.0, -90.0, 30.0, -30.0)
"""Where cameras of a vehicle look, from its heading: mostly ahead."""
ATTEMPTS = 4
"""Views tried until one shows as many vehicles as this picture should."""
EGO_SIZE_M = (4.6, 2.0)


def training_scene(seed: int, index: int) -> Scene:
    """The picture number `index` of the endless training set with this seed: one frame of one camera."""
    rng = np.random.default_rng([seed, 41, index])
    environment = _environment(seed, index, rng)
    place = build_place(environment.kind, environment.seed)
    shared = np.random.default_rng([seed, 42, index // PICTURES_PER_WARDROBE])
    wardrobe = draw_wardrobe(int(shared.integers(1 << 30)))
    fewest = int(rng.choice([0, 3, 6], p=[0.05, 0.35, 0.6]))
    for _ in range(ATTEMPTS):
        crowd, focal, height = _view(place, wardrobe, rng)
        _fill(crowd)
        if sum(thing.kind in VEHICLE_SHARES for thing in crowd.objects) >= fewest:
            break
    eye = crowd.eye
    view = crowd.view_yaw_rad - eye.yaw_rad
    return Scene(
        frames=1, rate_hz=10.0, cameras=(_camera(rng, view, focal, height),),
        objects=tuple(crowd.objects), seed=seed,
        environment=environment, imaging=random_imaging(rng), ego=standing(eye.x_m, eye.y_m, eye.yaw_rad),
        light_override=random_light(rng, environment),
    )  # fmt: skip


def _view(place: Place, wardrobe: Wardrobe, rng: np.random.Generator) -> tuple[Crowd, float, float]:
    """A standpoint with nothing around it yet, the camera's focal length (px) and its height (m)."""
    lane, (x, y) = _standpoint(place.layout, rng)
    heading = lane.yaw_rad + rng.normal(0.0, 0.06)
    view = math.radians(VIEWS_DEG[int(rng.integers(len(VIEWS_DEG)))] + rng.normal(0.0, 7.0))
    focal = float(np.exp(rng.uniform(math.log(400.0), math.log(1100.0))))
    half_view = math.atan(0.5 * IMAGE_SIZE_PX[0] / focal)
    eye = Footprint(x, y, heading, *EGO_SIZE_M)
    most = int(rng.integers(14, 46))
    crowd = Crowd(place, wardrobe, rng, eye, REACH_M, heading + view, half_view, most)
    return crowd, focal, float(rng.uniform(1.2, 2.3))


def _environment(seed: int, index: int, rng: np.random.Generator) -> Environment:
    shared = np.random.default_rng([seed, 43, index // PICTURES_PER_PLACE])
    kind = str(shared.choice(list(ENVIRONMENT_SHARES), p=list(ENVIRONMENT_SHARES.values())))
    light = str(rng.choice(["sun", "overcast", "dusk", "wet"], p=[0.5, 0.28, 0.12, 0.10]))
    return Environment(
        kind, int(shared.integers(1 << 30)), light,
        sun_azimuth_deg=round(float(rng.uniform(-180.0, 180.0)), 1),
        sun_elevation_deg=round(float(rng.uniform(14.0, 68.0)), 1),
    )  # fmt: skip


def _standpoint(layout: Layout, rng: np.random.Generator) -> tuple[Lane, tuple[float, float]]:
    """A lane and a place on it, not far from the origin."""
    lanes = layout.lanes
    for _ in range(40):
        lane = lanes[int(rng.integers(len(lanes)))]
        along = rng.uniform(0.0, lane.length_m)
        at = lane.at(float(along), float(rng.normal(0.0, 0.4)))
        if math.hypot(*at) < 55.0:
            return lane, at
    return lanes[0], lanes[0].at(0.5 * lanes[0].length_m)


def _fill(crowd: Crowd) -> None:
    """A crowd of a random mood: some streets are empty, some packed."""
    rng = crowd.rng
    steps = [
        lambda: crowd.park(float(rng.choice([0.1, 0.5, 0.8, 0.95]))),
        lambda: crowd.drive(float(rng.choice([9.0, 16.0, 30.0]))),
        lambda: crowd.walk(float(rng.choice([4.0, 9.0, 18.0, 40.0]))),
        lambda: crowd.scatter(int(rng.integers(2, 14)), int(rng.integers(0, 6))),
    ]
    for step in rng.permutation(len(steps)):
        steps[int(step)]()


def _camera(rng: np.random.Generator, view_rad: float, focal_px: float, height_m: float) -> CameraMount:
    width_px, height_px = IMAGE_SIZE_PX
    center = (0.5 * width_px - 0.5 + rng.normal(0.0, 8.0), 0.5 * height_px - 0.5 + rng.normal(0.0, 12.0))
    return mount(
        "camera", IMAGE_SIZE_PX, round(focal_px, 2), (0.0, 0.0, round(height_m, 3)),
        yaw_deg=math.degrees(view_rad), pitch_deg=float(rng.normal(1.0, 2.2)),
        roll_deg=float(rng.normal(0.0, 0.9)),
        center_px=(round(float(center[0]), 2), round(float(center[1]), 2)),
    )  # fmt: skip


def random_light(rng: np.random.Generator, environment: Environment) -> Light:
    """The environment's light, with its strength, haze and warmth varied."""
    base = environment.lighting()
    return Light(
        base.sun_direction,
        sun=base.sun * float(rng.uniform(0.6, 1.25)),
        sky=base.sky * float(rng.uniform(0.75, 1.25)),
        warmth=min(1.0, base.warmth + float(rng.uniform(0.0, 0.25))),
        haze_per_m=base.haze_per_m * float(np.exp(rng.normal(0.0, 0.6))),
        wetness=base.wetness * float(rng.uniform(0.6, 1.15)),
        headlights=base.headlights or bool(rng.random() < 0.15),
        seed=int(rng.integers(1 << 30)),
    )


def random_imaging(rng: np.random.Generator) -> Imaging:
    """A camera somewhere between good and poor."""
    motion = float(rng.uniform(1.0, 6.0)) if rng.random() < 0.12 else 0.0
    return Imaging(
        noise=float(rng.choice([0.5, 1.5, 3.0, 6.0], p=[0.3, 0.4, 0.2, 0.1]) * rng.uniform(0.6, 1.4)),
        blur_px=float(max(0.0, rng.normal(0.35, 0.35))),
        motion_px=motion,
        motion_rad=float(rng.normal(0.0, 0.2)),
        exposure_ev=float(rng.normal(0.0, 0.35)),
        white_balance=tuple(float(gain) for gain in rng.normal(1.0, 0.035, 3)),
        vignette=float(rng.uniform(0.0, 0.35)),
        aberration=float(rng.uniform(0.0, 0.0010)),
        jpeg_quality=int(rng.integers(60, 96)),
    )
