"""The training loop of a head. It takes a quarter of an hour, so it is not resumed: it is run again."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass

import torch
from torch import nn

from ..averaging import AveragedWeights
from .batches import PartsBatch, PartsPlan, batches
from .features import FrozenFeatures
from .losses import PartsLosses, parts_losses
from .network import PartsHead
from .recipe import Recipe
from .settings import PartsSettings
from .vehicles import Vehicle

PROGRESS_SECONDS = 15.0
# The learning rate ends at this share of its peak.
FINAL_RATE_SHARE = 0.02
MAX_GRADIENT_NORM = 5.0
ADAM_BETAS = (0.9, 0.99)

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
        self.optimiser = torch.optim.AdamW(
            _parameter_groups(self.head, settings.weight_decay), settings.learning_rate, ADAM_BETAS
        )
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
        for group in self.optimiser.param_groups:
            group["lr"] = self._learning_rate()
        maps = (torch.from_numpy(one) for one in self.features.of(batch.crops))
        maps = [one.to(memory_format=torch.channels_last) for one in maps]
        losses = parts_losses(*self.head(*maps), batch.targets)
        self.optimiser.zero_grad(set_to_none=True)
        losses.total.backward()
        nn.utils.clip_grad_norm_(self.head.parameters(), MAX_GRADIENT_NORM)
        self.optimiser.step()
        self.average.update(self.head)
        self.batches_done += 1
        return losses

    def _learning_rate(self) -> float:
        """Rises over the warm-up, then falls along half a cosine."""
        s = self.settings
        rise = min(1.0, (self.batches_done + 1) / s.warm_up_batches)
        fall = (1 + math.cos(math.pi * min(1.0, self.progress))) / 2
        return s.learning_rate * rise * (FINAL_RATE_SHARE + (1 - FINAL_RATE_SHARE) * fall)

    def _report(self, since: list[PartsLosses], seconds: float) -> None:
        heat, facing = (sum(getattr(one, part) for one in since) / len(since) for part in ("heat", "facing"))
        speed = len(since) * self.settings.batch_size / max(seconds, 1e-9)
        here = time.monotonic() - self.began
        left_minutes = max(0.0, (1 - self.progress) * here / max(self.progress, 1e-9) / 60)
        self.say(
            f"{100 * min(self.progress, 1):5.1f} %  {self.batches_done * self.settings.batch_size} crops  "
            f"heat {heat:.3f}  facing {facing:.3f}  {speed:.0f} crops/s  {left_minutes:.1f} min left"
        )


def _parameter_groups(network: nn.Module, weight_decay: float) -> list[dict]:
    """Only filters decay; biases and normalisation do not."""
    filters = [p for p in network.parameters() if p.ndim > 1]
    others = [p for p in network.parameters() if p.ndim <= 1]
    return [{"params": filters, "weight_decay": weight_decay}, {"params": others, "weight_decay": 0.0}]
