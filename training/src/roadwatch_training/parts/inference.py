"""A head's file over its detector, run the way the daemon runs them."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import onnxruntime

from ..errors import TrainingError
from .features import FeatureSource, FrozenFeatures, InputFormat


@dataclass(frozen=True)
class FoundParts:
    """Of n crops: components (n, components, 2) px, their scores (n, components), facing (n, bins)."""

    points_px: np.ndarray
    scores: np.ndarray
    facing: np.ndarray


class PartsModel:
    """The features and the head."""

    def __init__(self, detector: Path, head: Path, threads: int = 1) -> None:
        if not head.is_file():
            raise TrainingError(f"`{head}` does not exist: train a head first")
        options = onnxruntime.SessionOptions()
        options.intra_op_num_threads = threads
        self.session = onnxruntime.InferenceSession(str(head), options, providers=["CPUExecutionProvider"])
        stored = self.session.get_modelmeta().custom_metadata_map
        try:
            wanted = InputFormat(stored["detector_channels"], float(stored["detector_scale"]))
            source = FeatureSource(tuple(json.loads(stored["feature_tensors"])), wanted)
            self.components = tuple(json.loads(stored["components"]))
            self.thresholds = np.array(json.loads(stored["component_thresholds"]))
            self.side_px, self.cell_px = int(stored["crop_side_px"]), int(stored["cell_px"])
            sha256 = stored["detector_sha256"]
        except KeyError as error:
            raise TrainingError(f"`{head}` has no {error} in its metadata: it is no head") from error
        self.features = FrozenFeatures(detector, source, threads)
        if self.features.sha256 != sha256:
            raise TrainingError(f"`{head}` belongs to another detector than `{detector}`: hashes differ")

    def find(self, crops: np.ndarray) -> FoundParts:
        """In RGB uint8 crops (n, side, side, 3)."""
        maps = dict(zip(self.features.source.tensors, self.features.of(crops)))
        heat, facing = self.session.run(["heat", "facing"], maps)
        points, scores = peaks(heat, self.cell_px)
        return FoundParts(points, scores, facing)


def peaks(heat: np.ndarray, cell_px: int) -> tuple[np.ndarray, np.ndarray]:
    """The highest cell of every map, moved to the centroid of its 3x3 neighbourhood; and its value.

    Maps (n, components, rows, columns) give places (n, components, 2) in pixels of the crop, pixel centres at
    integers, and scores (n, components).
    """
    count, components, rows, columns = heat.shape
    flat = heat.reshape(count, components, -1)
    best = flat.argmax(-1)
    scores = np.take_along_axis(flat, best[..., None], -1)[..., 0]
    row, column = best // columns, best % columns
    padded = np.pad(heat, ((0, 0), (0, 0), (1, 1), (1, 1)))
    first = np.arange(count)[:, None, None, None], np.arange(components)[None, :, None, None]
    around = np.arange(3)
    near_rows = row[..., None, None] + around[:, None]
    near_columns = column[..., None, None] + around[None, :]
    near = padded[first[0], first[1], near_rows, near_columns]
    total = near.sum((-1, -2)).clip(min=1e-9)
    x = column + (near * (around - 1)[None, :]).sum((-1, -2)) / total
    y = row + (near * (around - 1)[:, None]).sum((-1, -2)) / total
    return np.stack((x, y), -1) * cell_px + (cell_px - 1) / 2, scores
