"""Vehicles of a rig dataset (`rig.toml`, `truth.jsonl`, a folder a camera), real or simulated, as crops."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..errors import TrainingError
from ..images import read_rgb
from .angles import observation_angle
from .components import COMPONENTS
from .crops import crop, placement
from .recipe import PartsExample

# Of the height of a cuboid's hull, what a detector's box covers, from the bottom (docs/method.md, section 3).
BOX_OF_HULL = 0.87


@dataclass(frozen=True)
class Clean:
    """Which vehicles count: docs/method.md's clean filter, with a height of one's own."""

    classes: frozenset[str] = frozenset({"car", "truck"})
    min_height_px: float = 40.0
    max_occluded: float = 0.3
    max_truncated: float = 0.05

    def admits(self, entry: dict) -> bool:
        return (
            entry["class"] in self.classes
            and entry["box_px"][3] - entry["box_px"][1] >= self.min_height_px
            and entry["occluded"] <= self.max_occluded
            and entry["truncated"] <= self.max_truncated
        )


def rig_examples(folder: Path, side_px: int, clean: Clean = Clean()) -> Iterator[PartsExample]:
    """Crops of the truth's boxes, made as high as a detector's; where components are is not known."""
    positions = _camera_positions(folder)
    with (folder / "truth.jsonl").open(encoding="utf-8") as lines:
        for line in map(json.loads, lines):
            entries = [entry for entry in line["objects"] if clean.admits(entry)]
            if not entries:
                continue
            image = read_rgb(folder / line["camera"] / f"{line['frame']:04d}.jpg")
            for entry in entries:
                left, top, right, bottom = entry["box_px"]
                box = (left, bottom - (bottom - top) * BOX_OF_HULL, right, bottom)
                camera_m = positions[line["camera"]]
                angle = observation_angle(entry["yaw_base_rad"], entry["center_base_m"], camera_m)
                made = framed(image, box, side_px, angle)
                if made is not None:
                    yield made


def framed(
    image: np.ndarray, box_px: tuple[float, float, float, float], side_px: int, angle_rad: float
) -> PartsExample | None:
    """A box's crop; None when it holds no pixel."""
    place = placement(box_px, (image.shape[1], image.shape[0]), side_px)
    if place is None:
        return None
    nowhere, unseen = np.zeros((len(COMPONENTS), 2)), np.zeros(len(COMPONENTS), bool)
    return PartsExample(crop(image, place, side_px), nowhere, unseen, angle_rad)


def _camera_positions(folder: Path) -> dict[str, list[float]]:
    path = folder / "rig.toml"
    if not path.is_file() or not (folder / "truth.jsonl").is_file():
        raise TrainingError(f"`{folder}` is no rig dataset with truth: rig.toml or truth.jsonl is missing")
    cameras = tomllib.loads(path.read_text(encoding="utf-8"))["camera"]
    return {camera["name"]: camera["position_m"] for camera in cameras}
