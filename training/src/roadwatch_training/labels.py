"""Labelled images: `images/*.jpg` and `labels.jsonl`, as `roadwatch-simulate training` writes them."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .classes import class_number
from .errors import TrainingError

# An object hidden more than this is neither sought nor held against the network.
MAX_OCCLUDED = 0.7
# Hidden more than this, nothing of it can be seen: what is in front is all there is.
INVISIBLE_OCCLUDED = 0.97


Box = tuple[float, float, float, float]


@dataclass(frozen=True)
class ObjectLabel:
    """One object of an image.

    `box_px` is its silhouette's box (left, top, right, bottom; edges, pixels of the image), `visible_px` that of
    what is seen of it; `occluded` and `truncated` are shares, 0 to 1. An object that is not `sought` costs nothing whether it is found or not.
    """

    class_number: int
    box_px: Box
    visible_px: Box
    occluded: float
    truncated: float
    sought: bool

    @property
    def height_px(self) -> float:
        return self.box_px[3] - self.box_px[1]


@dataclass(frozen=True)
class LabelledImage:
    """An image file and what is in it."""

    path: Path
    objects: tuple[ObjectLabel, ...]

    def target_rows(self) -> np.ndarray:
        """Float32 (objects, 6): class, left, top, right, bottom, 1 if sought else 0."""
        rows = [(o.class_number, *o.box_px, float(o.sought)) for o in self.objects]
        return np.array(rows, np.float32).reshape(-1, 6)


def read_folder(folder: Path) -> list[LabelledImage]:
    """All labelled images of a folder, in the order of its `labels.jsonl`."""
    path = folder / "labels.jsonl"
    if not path.is_file():
        raise TrainingError(
            f"`{path}` does not exist: make it with `roadwatch-simulate training`, or give another --data"
        )
    images = []
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1):
        if not line.strip():
            continue
        try:
            images.append(_labelled_image(folder, json.loads(line), len(images)))
        except (KeyError, TypeError, ValueError) as error:
            raise TrainingError(f"`{path}`, line {number}: {error!r} is missing or malformed") from error
    if not images:
        raise TrainingError(f"`{path}` has no lines: nothing to learn from")
    return images


def _labelled_image(folder: Path, line: dict, position: int) -> LabelledImage:
    name = str(line.get("image", f"{position:06d}.jpg"))
    path = folder / name if (folder / name).is_file() else folder / "images" / name
    objects = (_object_label(entry) for entry in line["objects"])
    return LabelledImage(path, tuple(label for label in objects if label is not None))


def _object_label(entry: dict) -> ObjectLabel | None:
    """None for classes that the detector does not know and for objects of which nothing can be seen."""
    number = class_number(entry["class"])
    box = entry["silhouette_px"]
    occluded = float(entry.get("occluded", 0.0))
    if number is None or box is None or entry["visible_px"] is None or occluded > INVISIBLE_OCCLUDED:
        return None
    return ObjectLabel(
        class_number=number,
        box_px=_box(box),
        visible_px=_box(entry["visible_px"]),
        occluded=occluded,
        truncated=float(entry.get("truncated", 0.0)),
        sought=occluded <= MAX_OCCLUDED,
    )


def _box(edges: list) -> Box:
    left, top, right, bottom = (float(edge) for edge in edges)
    return left, top, right, bottom
