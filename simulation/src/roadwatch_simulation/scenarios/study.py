"""What `roadwatch study` measures on beside the paper's own set-ups: a longer path, and every kind of vehicle."""

from __future__ import annotations

import math

import numpy as np

from ..motion import Path, Waypoint
from ..scene import Environment, Scene, SceneObject
from ..scenery import Footprint
from . import paper

LONG_PATH_M = (6.0, 60.0)
VEHICLE_KINDS = ("sedan", "compact", "suv", "pickup", "minivan", "wagon", "sports", "van", "bus", "truck")
VEHICLES_PER_FRAME = 5
NEAREST_M = 7.0
FARTHEST_M = 60.0
LONG_NEAREST_M = 14.0
"""Nearer, a bus or a lorry does not fit into the picture."""
ROWS_M = (15.0, 30.0, 45.0)
"""The paper calibrates at 30 m; nearer and farther show what that does elsewhere."""
ROW_ASIDE_M = (8.0, 0.0, -8.0)
EDGE_RAD = 0.03
"""Kept free at both edges of the picture, and between two vehicles as seen from the camera."""
ATTEMPTS = 60
AWAY_M = -40.0
"""Vehicles that are not in a frame stand in a row so far behind the camera."""
AWAY_STEP_M = 6.0


def long_path(seed: int, frames: int) -> Scene:
    """A car drives away along the optical axis, from 6 to 60 m."""
    near, far = LONG_PATH_M
    return paper.one_car(seed, frames, paper.evenly((near, 0.0), (far, 0.0), frames))


def car_row(seed: int, frames: int) -> Scene:
    """Three cars side by side that face away, in a row 15, 30 and 45 m ahead in turns; then three others."""
    cars = []
    for trio in range(math.ceil(frames / len(ROWS_M))):
        for place, aside in enumerate(ROW_ASIDE_M):
            number = trio * len(ROW_ASIDE_M) + place
            waypoints = []
            for frame in range(frames):
                shown = frame // len(ROWS_M) == trio
                x, y = (ROWS_M[frame % len(ROWS_M)], aside) if shown else (AWAY_M, number * AWAY_STEP_M)
                waypoints.append(Waypoint(frame / paper.RATE_HZ, x, y, 0.0))
            kind = paper.PATH_KINDS[(number + trio) % len(paper.PATH_KINDS)]
            cars.append(SceneObject(f"car {number}", kind, seed * 1000 + number, Path(tuple(waypoints))))
    return _on_the_plain(seed, frames, tuple(cars))


def vehicles(seed: int, frames: int) -> Scene:
    """Every kind of vehicle at random places and headings, five in a frame, none in front of another."""
    rng = np.random.default_rng([seed, 61])
    fleet = [SceneObject(kind, kind, seed * 100 + at, Path(()))
             for at, kind in enumerate(VEHICLE_KINDS)]  # fmt: skip
    waypoints: list[list[Waypoint]] = [[] for _ in fleet]
    for frame in range(frames):
        shown = _arranged(fleet, frame, rng)
        for index, poses in enumerate(waypoints):
            x, y, yaw = shown.get(index, (AWAY_M, (index - len(fleet) / 2) * AWAY_STEP_M, 0.0))
            poses.append(Waypoint(frame / paper.RATE_HZ, x, y, yaw))
    objects = tuple(SceneObject(thing.name, thing.kind, thing.seed, Path(tuple(poses)))
                    for thing, poses in zip(fleet, waypoints, strict=True))  # fmt: skip
    return _on_the_plain(seed, frames, objects)


def _on_the_plain(seed: int, frames: int, objects: tuple[SceneObject, ...]) -> Scene:
    """The full-HD camera over these objects."""
    return Scene(
        frames=frames, rate_hz=paper.RATE_HZ, cameras=(paper.camera(),), objects=objects, seed=seed,
        environment=Environment("plain", seed, "sun" if seed % 2 == 0 else "overcast", 150.0, 40.0),
    )  # fmt: skip


def _arranged(
    fleet: list[SceneObject], frame: int, rng: np.random.Generator
) -> dict[int, tuple[float, float, float]]:
    """Places of some of the fleet, taken in turns so that each kind comes as often as every other."""
    half_view = math.atan(0.5 * paper.SIZE_PX[0] / paper.FOCAL_PX)
    taken: list[tuple[float, float]] = []
    shown = {}
    for turn in range(VEHICLES_PER_FRAME):
        index = (frame * VEHICLES_PER_FRAME + turn) % len(fleet)
        length, width, _ = fleet[index].model.size_lwh_m
        nearest = LONG_NEAREST_M if length > NEAREST_M else NEAREST_M
        for _ in range(ATTEMPTS):
            distance = float(rng.uniform(nearest, FARTHEST_M))
            azimuth, yaw = float(rng.uniform(-half_view, half_view)), float(rng.uniform(0.0, 2.0 * math.pi))
            at = Footprint(distance * math.cos(azimuth), distance * math.sin(azimuth), yaw, length, width)
            left, right = _span(at)
            in_view = -half_view < left - EDGE_RAD and right + EDGE_RAD < half_view
            if in_view and all(right + EDGE_RAD < a or b + EDGE_RAD < left for a, b in taken):
                taken.append((left, right))
                shown[index] = (at.x_m, at.y_m, yaw)
                break
    return shown


def _span(at: Footprint) -> tuple[float, float]:
    """Least and greatest azimuth of a rectangle's corners as seen from the origin."""
    angles = [math.atan2(y, x) for x, y in at.corners()]
    return min(angles), max(angles)
