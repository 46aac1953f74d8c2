"""The paper's own set-ups: one full-HD camera on a plain, and one car on a path, turning, or on a grid."""

from __future__ import annotations

import math

import numpy as np

from ..motion import Path, Waypoint, straight
from ..rig import CameraMount, mount
from ..scene import Environment, Scene, SceneObject

SIZE_PX = (1920, 1080)
FOCAL_PX = 1400.0
"""Close to the focal values that the paper prints (1375 to 1964)."""
CAMERA_HEIGHT_M = 1.6
RATE_HZ = 10.0
PATH_KINDS = ("sedan", "compact", "suv", "wagon", "minivan")
TURNTABLE_M = 12.0
GRID_STEP_M = 3.0
GRID_AHEAD_M = (6.0, 48.0)
GRID_ASIDE_M = 15.0
CAR_MARGIN_M = 2.8
"""A car needs so much room between its middle and the edge of the picture."""


def y_path(seed: int, frames: int) -> Scene:
    """A car drives away along the optical axis, from 8 to 45 m."""
    return one_car(seed, frames, evenly((8.0, 0.0), (45.0, 0.0), frames))


def x_path(seed: int, frames: int) -> Scene:
    """A car crosses 30 m ahead, from 12 m left to 12 m right."""
    return one_car(seed, frames, evenly((30.0, 12.0), (30.0, -12.0), frames))


def turntable(seed: int, frames: int) -> Scene:
    """A car 12 m ahead turns once about itself, from facing away (0) to 360 degrees."""
    turn = 2.0 * math.pi / frames
    waypoints = (Waypoint(frame / RATE_HZ, TURNTABLE_M, 0.0, frame * turn) for frame in range(frames))
    return one_car(seed, frames, Path(tuple(waypoints)))


def grid(seed: int, frames: int) -> Scene:
    """A car stands in every cell of a grid once, at a random heading; longer runs go over the grid again."""
    rng = np.random.default_rng([seed, 51])
    cells = grid_cells()
    waypoints = []
    for frame in range(frames):
        ahead, aside = cells[frame % len(cells)] + rng.uniform(-0.4, 0.4, 2) * GRID_STEP_M
        yaw = float(rng.uniform(0.0, 2.0 * math.pi))
        waypoints.append(Waypoint(frame / RATE_HZ, float(ahead), float(aside), yaw))
    return one_car(seed, frames, Path(tuple(waypoints)))


def grid_cells() -> np.ndarray:
    """Middles (x ahead, y left; m) of the cells in which a whole car is seen."""
    widest = 0.5 * SIZE_PX[0] / FOCAL_PX
    half = 0.5 * GRID_STEP_M
    cells = [
        (ahead, aside)
        for ahead in np.arange(GRID_AHEAD_M[0] + half, GRID_AHEAD_M[1], GRID_STEP_M)
        for aside in np.arange(-GRID_ASIDE_M, GRID_ASIDE_M + 0.1, GRID_STEP_M)
        if abs(aside) + half + CAR_MARGIN_M < widest * (ahead - half - CAR_MARGIN_M) + half
    ]
    return np.array(cells)


def evenly(start: tuple[float, float], end: tuple[float, float], frames: int) -> Path:
    """From `start` (x, y; m) to `end`, the same step from each frame to the next."""
    speed = math.dist(start, end) / max(1, frames - 1) * RATE_HZ
    return straight(start, end, 0.0, speed)


def one_car(seed: int, frames: int, path: Path) -> Scene:
    """One car on a plain, of a kind that follows from the seed."""
    kind = PATH_KINDS[seed % len(PATH_KINDS)]
    light = "sun" if seed % 2 == 0 else "overcast"
    return Scene(
        frames=frames, rate_hz=RATE_HZ, cameras=(camera(),), objects=(SceneObject("car", kind, seed, path),),
        seed=seed, environment=Environment("plain", seed, light, 150.0, 40.0),
    )  # fmt: skip


def camera() -> CameraMount:
    """The full-HD camera, level over the origin."""
    return mount("camera", SIZE_PX, FOCAL_PX, (0.0, 0.0, CAMERA_HEIGHT_M))
