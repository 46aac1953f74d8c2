"""The training loop of a head. It takes a quarter of an hour, so it is not resumed: it is run again."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import torch

from ..averaging import AveragedWeights
from ..descent import descend, learning_rate, optimiser_of
from .batches import PartsBatch, PartsPlan, batches
from .features import FrozenFeatures
from .losses import PartsLosses, parts_losses
from .network import PartsHead
from .recipe import Recipe
from .settings import PartsSettings
from .vehicles import Vehicle

PROGRESS_SECONDS = 15.0
MAX_GRADIENT_NORM = 5.0

Say = Callable[[str], None]


@dataclass(frozen=True)
class TrainedHead:
    """The averaged head, ready to be exported, and what it took."""

    head: PartsHead
    crops: int
    seconds: float


class PartsTraining:
    """Trains a head over a detector's features."""

    def __init__(
        self, settings: PartsSettings, features: FrozenFeatures, say: Say, recipe: Recipe = Recipe()
    ) -> None:
        self.settings, self.features, self.say, self.recipe = settings, features, say, recipe
        torch.manual_seed(settings.seed)
        torch.set_num_threads(settings.threads)
        head = PartsHead(features.channels(), settings.side_px)
        self.head = head.to(memory_format=torch.channels_last)
        self.average = AveragedWeights(self.head)
        self.optimiser = optimiser_of(self.head, settings.learning_rate, settings.weight_decay)
        self.batches_done = 0
        self.began = time.monotonic()

    @property
    def progress(self) -> float:
        """0 at the start, 1 or more when done."""
        by_crops = self.batches_done / self.settings.batches
        if self.settings.minutes is None:
            return by_crops
        return max(by_crops, (time.monotonic() - self.began) / (60 * self.settings.minutes))

    def run(self, vehicles: list[Vehicle]) -> TrainedHead:
        """Trains to the end."""
        s = self.settings
        self.began = time.monotonic()
        made = batches(vehicles, PartsPlan(s.seed, s.batch_size, s.side_px, self.recipe), s.workers)
        since, said = [], time.monotonic()
        while self.progress < 1:
            since.append(self._step(next(made)))
            if time.monotonic() - said >= PROGRESS_SECONDS or self.progress >= 1:
                self._report(since, time.monotonic() - said)
                since, said = [], time.monotonic()
        seconds = time.monotonic() - self.began
        return TrainedHead(self.average.network, self.batches_done * s.batch_size, seconds)

    def _step(self, batch: PartsBatch) -> PartsLosses:
        self.head.train()
        maps = (torch.from_numpy(one) for one in self.features.of(batch.crops))
        maps = [one.to(memory_format=torch.channels_last) for one in maps]
        losses = parts_losses(*self.head(*maps), batch.targets)
        s = self.settings
        rate = learning_rate(s.learning_rate, s.warm_up_batches, self.batches_done, self.progress)
        descend(self.head, self.optimiser, losses.total, rate, MAX_GRADIENT_NORM)
        self.average.update(self.head)
        self.batches_done += 1
        return losses

    def _report(self, since: list[PartsLosses], seconds: float) -> None:
        heat, facing = (sum(getattr(one, part) for one in since) / len(since) for part in ("heat", "facing"))
        speed = len(since) * self.settings.batch_size / max(seconds, 1e-9)
        here = time.monotonic() - self.began
        left_minutes = max(0.0, (1 - self.progress) * here / max(self.progress, 1e-9) / 60)
        self.say(
            f"{100 * min(self.progress, 1):5.1f} %  {self.batches_done * self.settings.batch_size} crops  "
            f"heat {heat:.3f}  facing {facing:.3f}  {speed:.0f} crops/s  {left_minutes:.1f} min left"
        )
