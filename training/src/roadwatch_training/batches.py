"""Batches of examples, prepared beside the training in a process of their own.

Example number n of a seed is always the same, whatever ran before, so that a resumed training sees what an
uninterrupted one would have seen.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import cv2
import numpy as np
import torch
from torch import Tensor
from torch.utils.data import DataLoader, IterableDataset, get_worker_info

from .assignment import Targets
from .augment.example import Example
from .augment.geometry import Framing
from .augment.recipe import Recipe, example
from .images import ImageStore


@dataclass(frozen=True)
class Batch:
    """Images uint8 (batch, height, width, 3) RGB, and what is in them."""

    images: Tensor
    targets: Targets

    def to(self, device: torch.device) -> Batch:
        """The same on another device."""
        return Batch(self.images.to(device, non_blocking=True), self.targets.to(device))

    def network_input(self) -> Tensor:
        """RGB 0 to 1, (batch, 3, height, width), channels last in memory, which trains faster."""
        return self.images.permute(0, 3, 1, 2).float().div_(255.0)


@dataclass(frozen=True)
class BatchPlan:
    """Which examples are made, and how."""

    seed: int
    batch_size: int
    framing: Framing
    recipe: Recipe


class ExampleBatches(IterableDataset):
    """Batches from number `first` on, without end."""

    def __init__(self, store: ImageStore, plan: BatchPlan, first: int = 0) -> None:
        self.store, self.plan, self.first = store, plan, first

    def __iter__(self) -> Iterator[Batch]:
        worker = get_worker_info()
        number, step = self.first, 1
        if worker is not None:
            number, step = number + worker.id, worker.num_workers
        while True:
            yield self.batch(number)
            number += step

    def batch(self, number: int) -> Batch:
        """Batch `number`."""
        plan = self.plan
        numbers = range(number * plan.batch_size, (number + 1) * plan.batch_size)
        draws = (np.random.default_rng((plan.seed, n)) for n in numbers)
        return collated([example(self.store, plan.framing, plan.recipe, rng) for rng in draws])


def batches(store: ImageStore, plan: BatchPlan, first: int, workers: int) -> Iterator[Batch]:
    """Batches in order; `workers` processes make them, none when 0."""
    # OpenCV's pool of threads does not live on in a forked process, which would wait for it for ever.
    cv2.setNumThreads(0)
    ahead = 3 if workers else None
    dataset = ExampleBatches(store, plan, first)
    return iter(DataLoader(dataset, batch_size=None, num_workers=workers, prefetch_factor=ahead))


def collated(examples: list[Example]) -> Batch:
    """Examples of one size as a batch, objects padded to the most that any has."""
    most = max(1, *(len(e.rows) for e in examples))
    rows = torch.zeros(len(examples), most, 6)
    present = torch.zeros(len(examples), most, dtype=torch.bool)
    for at, made in enumerate(examples):
        rows[at, : len(made.rows)] = torch.from_numpy(made.rows)
        present[at, : len(made.rows)] = True
    sought = present & (rows[..., 5] > 0)
    targets = Targets(rows[..., 1:5].contiguous(), rows[..., 0].long(), sought, present & ~sought)
    return Batch(torch.from_numpy(np.stack([e.image for e in examples])), targets)
