"""What a training needs to go on after it was killed."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

import torch

from .errors import TrainingError

FILE_NAME = "checkpoint.pt"


@dataclass(frozen=True)
class Checkpoint:
    """States of network, average and optimiser, batches done, seconds spent, settings as a dictionary."""

    network: dict
    average: dict
    optimiser: dict
    batches_done: int
    seconds_spent: float
    settings: dict

    def write(self, folder: Path) -> None:
        """Replaces the folder's checkpoint; a kill in between leaves the old one."""
        folder.mkdir(parents=True, exist_ok=True)
        unfinished = folder / f"{FILE_NAME}.unfinished"
        torch.save(vars(self), unfinished)
        os.replace(unfinished, folder / FILE_NAME)

    @classmethod
    def read(cls, folder: Path) -> Checkpoint:
        path = folder / FILE_NAME
        if not path.is_file():
            raise TrainingError(f"`{path}` does not exist, nothing to go on from: leave out --resume")
        try:
            return cls(**torch.load(path, map_location="cpu", weights_only=True))
        except (RuntimeError, TypeError, EOFError, OSError) as error:
            raise TrainingError(f"`{path}` is no checkpoint of this program: {error}") from error
