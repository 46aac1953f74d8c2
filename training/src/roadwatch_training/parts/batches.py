"""Batches of crops, prepared beside the training in a process of their own.

Example number n of a seed is always the same.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np
import torch
from torch.utils.data import DataLoader, IterableDataset, get_worker_info

from .losses import PartsTargets
from .recipe import PartsExample, Recipe, example
from .vehicles import Vehicle

# Cars are most of the traffic and most of what is asked for.
CLASS_WEIGHTS = {"car": 1.0, "truck": 0.5, "bus": 0.35}
# Vehicles of fewer pixels come up less often, in proportion.
FULL_WEIGHT_HEIGHT_PX, LEAST_SIZE_WEIGHT = 48.0, 0.4


@dataclass(frozen=True)
class PartsBatch:
    """Crops uint8 (batch, side, side, 3) RGB, and what is in them."""

    crops: np.ndarray
    targets: PartsTargets


@dataclass(frozen=True)
class PartsPlan:
    """Which examples are made, and how."""

    seed: int
    batch_size: int
    side_px: int
    recipe: Recipe


class PartsBatches(IterableDataset):
    """Batches without end."""

    def __init__(self, vehicles: list[Vehicle], plan: PartsPlan) -> None:
        self.vehicles, self.plan = vehicles, plan
        weights = np.array([_weight(vehicle) for vehicle in vehicles])
        self.cumulative = np.cumsum(weights / weights.sum())

    def __iter__(self) -> Iterator[PartsBatch]:
        worker = get_worker_info()
        number, step = (0, 1) if worker is None else (worker.id, worker.num_workers)
        while True:
            yield self.batch(number)
            number += step

    def batch(self, number: int) -> PartsBatch:
        """Batch `number`."""
        size = self.plan.batch_size
        return collated([self._example(n) for n in range(number * size, (number + 1) * size)])

    def _example(self, number: int) -> PartsExample:
        rng = np.random.default_rng((self.plan.seed, number))
        at = int(np.searchsorted(self.cumulative, rng.random()).clip(max=len(self.vehicles) - 1))
        return example(self.vehicles[at], self.plan.side_px, self.plan.recipe, rng)


def batches(vehicles: list[Vehicle], plan: PartsPlan, workers: int) -> Iterator[PartsBatch]:
    """Batches in order; `workers` processes make them, none when 0."""
    # OpenCV's pool of threads does not live on in a forked process, which would wait for it for ever.
    cv2.setNumThreads(0)
    ahead = 3 if workers else None
    dataset = PartsBatches(vehicles, plan)
    return iter(DataLoader(dataset, batch_size=None, num_workers=workers, prefetch_factor=ahead))


def collated(examples: list[PartsExample]) -> PartsBatch:
    """Examples of one size as a batch."""
    points = torch.from_numpy(np.stack([made.points_px for made in examples])).float()
    visible = torch.from_numpy(np.stack([made.visible for made in examples]))
    angles = torch.tensor([made.angle_rad for made in examples])
    return PartsBatch(np.stack([made.crop for made in examples]), PartsTargets(points, visible, angles))


def _weight(vehicle: Vehicle) -> float:
    height = vehicle.seen_px[3] - vehicle.seen_px[1]
    size = min(max(height / FULL_WEIGHT_HEIGHT_PX, LEAST_SIZE_WEIGHT), 1.0)
    return CLASS_WEIGHTS[vehicle.class_name] * size
