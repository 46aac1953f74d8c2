"""Vehicles out of simulated pictures, each with the pixels around it, its components and its angle."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from ..classes import VEHICLE_CLASSES
from ..errors import TrainingError
from ..images import read_rgb
from .angles import observation_angle
from .components import COMPONENTS

# Below this, a box holds too few pixels for any component.
MIN_HEIGHT_PX, MIN_WIDTH_PX = 18.0, 20.0
MAX_OCCLUDED, MAX_TRUNCATED = 0.65, 0.6
CLEAN_HEIGHT_PX, CLEAN_OCCLUDED, CLEAN_TRUNCATED = 20.0, 0.3, 0.05
# Kept around a box, share of its sides: boxes are jittered within it.
MARGIN = 0.15
# Longer sides of what is kept, pixels: no crop asks for more.
MAX_KEPT_PX = 420
# Pictures in a row share a set of vehicle models and places (`scenarios.training`); every tenth such group
# is held out, so that what it is scored on has shapes and surroundings that were never trained on.
PICTURES_PER_GROUP, GROUPS = 24, 10


@dataclass(frozen=True)
class Vehicle:
    """One vehicle, in pixels of `pixels` (height, width, 3) RGB, which end where the picture ends.

    `whole_px` is the box of all of it within the picture, `seen_px` of what nothing hides; left, top, right,
    bottom. `points_px` (components, 2) and `visible` (components,) are in the order of COMPONENTS; those that
    the vehicle lacks are not visible.
    """

    class_name: str
    pixels: np.ndarray
    whole_px: np.ndarray
    seen_px: np.ndarray
    points_px: np.ndarray
    visible: np.ndarray
    angle_rad: float
    occluded: float
    truncated: float

    @property
    def is_clean_car(self) -> bool:
        """docs/method.md's clean filter, section 9: what every score counts."""
        height = self.seen_px[3] - self.seen_px[1]
        shares = self.occluded <= CLEAN_OCCLUDED and self.truncated <= CLEAN_TRUNCATED
        return self.class_name == "car" and height >= CLEAN_HEIGHT_PX and shares


@dataclass(frozen=True)
class VehicleSets:
    """For training, and held out."""

    trained_on: list[Vehicle]
    held_out: list[Vehicle]


def read_vehicles(folder: Path, progress: Callable[[int, int], None] = lambda _, __: None) -> VehicleSets:
    """All usable vehicles of a folder that `roadwatch-simulate training` wrote, finished or not."""
    path = folder / "labels.jsonl"
    if not path.is_file():
        raise TrainingError(
            f"`{path}` does not exist: make it with `roadwatch-simulate training`, or give another --data"
        )
    sets = VehicleSets([], [])
    lines = [line for line in path.read_text(encoding="utf-8").split("\n")[:-1] if line.strip()]
    for number, text in enumerate(lines, start=1):
        try:
            line = json.loads(text)
            chosen = sets.held_out if is_held_out(line["image"]) else sets.trained_on
            chosen.extend(_vehicles(folder, line))
        except (KeyError, TypeError, ValueError) as error:
            raise TrainingError(f"`{path}`, line {number}: {error!r} is missing or malformed") from error
        progress(number, len(lines))
    return sets


def is_held_out(image_name: str) -> bool:
    """By the picture's number, `images/000123.jpg`."""
    return int(Path(image_name).stem) // PICTURES_PER_GROUP % GROUPS == GROUPS - 1


def _vehicles(folder: Path, line: dict) -> list[Vehicle]:
    wanted = [entry for entry in line["objects"] if _is_usable(entry)]
    if not wanted:
        return []
    image = read_rgb(folder / line["image"])
    return [_vehicle(image, entry, line["position_m"]) for entry in wanted]


def _is_usable(entry: dict) -> bool:
    if entry["class"] not in VEHICLE_CLASSES or entry["visible_px"] is None:
        return False
    left, top, right, bottom = entry["visible_px"]
    return (
        bottom - top >= MIN_HEIGHT_PX
        and right - left >= MIN_WIDTH_PX
        and entry["occluded"] <= MAX_OCCLUDED
        and entry["truncated"] <= MAX_TRUNCATED
    )


def _vehicle(image: np.ndarray, entry: dict, camera_m: list[float]) -> Vehicle:
    whole = np.array(entry["silhouette_px"], float)
    corner, scale, pixels = _kept_pixels(image, whole)
    points, visible = np.zeros((len(COMPONENTS), 2)), np.zeros(len(COMPONENTS), bool)
    for part in entry["parts"]:
        if part["name"] in COMPONENTS:
            at = COMPONENTS.index(part["name"])
            points[at] = (np.array([part["x_px"], part["y_px"]]) + 0.5 - corner) * scale - 0.5
            visible[at] = part["visible"]
    edges = [(np.array(box, float) - np.tile(corner, 2)) * scale for box in (whole, entry["visible_px"])]
    angle = observation_angle(entry["yaw_base_rad"], entry["center_base_m"], camera_m)
    shares = (float(entry["occluded"]), float(entry["truncated"]))
    return Vehicle(entry["class"], pixels, *edges, points, visible, angle, *shares)


def _kept_pixels(image: np.ndarray, box: np.ndarray) -> tuple[np.ndarray, float, np.ndarray]:
    """The picture around a box: its corner there, how much smaller it is kept, and the pixels."""
    margin = np.ceil((box[2:] - box[:2]) * MARGIN) + 2
    low = np.maximum(np.floor(box[:2] - margin), 0).astype(int)
    high = np.minimum(np.ceil(box[2:] + margin), image.shape[1::-1]).astype(int)
    pixels = image[low[1] : high[1], low[0] : high[0]]
    scale = min(1.0, MAX_KEPT_PX / max(pixels.shape[:2]))
    if scale == 1.0:
        return low.astype(float), scale, pixels.copy()
    size = (round(pixels.shape[1] * scale), round(pixels.shape[0] * scale))
    return low.astype(float), scale, cv2.resize(pixels, size, interpolation=cv2.INTER_AREA)
