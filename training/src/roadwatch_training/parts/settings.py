"""Everything about a head's training that is a choice."""

from __future__ import annotations

from dataclasses import dataclass

from ..errors import TrainingError
from .features import FEATURE_STRIDES


@dataclass(frozen=True)
class PartsSettings:
    """`crops` counts presentations. `minutes` ends the training earlier, None never."""

    side_px: int = 192
    batch_size: int = 32
    crops: int = 60_000
    minutes: float | None = None
    seed: int = 1
    learning_rate: float = 3e-3
    weight_decay: float = 0.02
    warm_up_batches: int = 50
    workers: int = 1
    threads: int = 1

    def __post_init__(self) -> None:
        if self.side_px % FEATURE_STRIDES[-1] or self.side_px <= 0:
            raise TrainingError(f"--side is {self.side_px}; it must be a multiple of {FEATURE_STRIDES[-1]}")
        if self.batch_size < 2 or self.crops < self.batch_size:
            raise TrainingError("--batch must be 2 or more (batch normalisation), --crops at least as many")
        if self.minutes is not None and self.minutes <= 0:
            raise TrainingError("--minutes must be more than 0")

    @property
    def batches(self) -> int:
        return self.crops // self.batch_size
