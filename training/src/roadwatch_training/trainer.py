"""The training loop."""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import torch
from torch import nn

from .augment.geometry import Framing
from .augment.recipe import Recipe
from .averaging import AveragedWeights
from .batches import Batch, BatchPlan, batches
from .checkpoint import Checkpoint
from .descent import descend, learning_rate, optimiser_of
from .device import training_device
from .errors import TrainingError
from .exported import read_exported, settle_normalisation
from .images import ImageStore
from .losses import Losses, detection_losses
from .network import SHAPES, Cells, DetectorNetwork
from .settings import Settings

CHECKPOINT_SECONDS = 120.0
PROGRESS_SECONDS = 10.0
MAX_GRADIENT_NORM = 10.0
# Batches that say what an exported network's normalisations undo: five hundred examples settle a mean.
SETTLING_BATCHES = 60

Say = Callable[[str], None]


@dataclass(frozen=True)
class Trained:
    """The averaged network, ready to be exported, and what it took."""

    network: DetectorNetwork
    images: int
    seconds: float


class Training:
    """A training that can be interrupted: `run` goes on from wherever the state is."""

    def __init__(self, settings: Settings, store: ImageStore, folder: Path, say: Say) -> None:
        self.settings, self.store, self.folder, self.say = settings, store, folder, say
        torch.manual_seed(settings.seed)
        if settings.threads:
            torch.set_num_threads(settings.threads)
        self.device = training_device()
        network = DetectorNetwork(SHAPES[settings.width])
        self.network = network.to(self.device, memory_format=torch.channels_last)
        self.average = AveragedWeights(self.network)
        self.optimiser = optimiser_of(self.network, settings.learning_rate, settings.weight_decay)
        self.cells = Cells.of_input(settings.width_px, settings.height_px).to(self.device)
        self.settled = True
        self.batches_done = 0
        self.seconds_before = 0.0
        self.began = time.monotonic()

    def resume(self) -> None:
        """Takes up the state of the folder's checkpoint."""
        state = Checkpoint.read(self.folder)
        self.network.load_state_dict(state.network)
        self.average.load_state_dict(state.average)
        self.optimiser.load_state_dict(state.optimiser)
        self.batches_done, self.seconds_before = state.batches_done, state.seconds_spent

    def start_from(self, run: Path) -> None:
        """Begins with the weights of another training of the same width instead of random ones.

        `run` is that training's folder, whose averaged weights are taken, or an exported `.onnx` file.
        """
        if run.suffix == ".onnx":
            read_exported(run, self.network)
            self.settled = False
            return
        state = Checkpoint.read(run)
        if state.settings["width"] != self.settings.width:
            raise TrainingError(
                f"`{run}` holds weights of --width {state.settings['width']}, not {self.settings.width}"
            )
        self.average.load_state_dict(state.average)
        self.network.load_state_dict(self.average.network.state_dict())

    def _settle(self, made: Iterator[Batch]) -> None:
        """Lets the first examples say what the normalisations of exported weights undo."""
        settling = itertools.islice(made, SETTLING_BATCHES)
        settle_normalisation(self.network, (batch.to(self.device).network_input() for batch in settling))
        self.average = AveragedWeights(self.network)
        self.settled = True

    @property
    def seconds(self) -> float:
        return self.seconds_before + time.monotonic() - self.began

    @property
    def progress(self) -> float:
        """0 at the start, 1 or more when done."""
        by_images = self.batches_done / self.settings.batches
        if self.settings.minutes is None:
            return by_images
        return max(by_images, self.seconds / (60 * self.settings.minutes))

    def run(self) -> Trained:
        """Trains to the end."""
        self.began = time.monotonic()
        # Before anything is computed: a process forked beside busy threads may wait for them for ever.
        made = batches(self.store, self._plan(), self.batches_done, self.settings.workers)
        if not self.settled:
            self._settle(made)
        step = torch.compile(self.network) if self.settings.compiled else self.network
        report = ProgressReport(self)
        saved = time.monotonic()
        while self.progress < 1:
            report.add(self._step(step, next(made)))
            if time.monotonic() - saved > CHECKPOINT_SECONDS:
                self.save()
                saved = time.monotonic()
        self.save()
        report.say()
        return Trained(self.average.network.cpu(), self.batches_done * self.settings.batch_size, self.seconds)

    def save(self) -> None:
        """Writes the checkpoint."""
        Checkpoint(
            network=self.network.state_dict(),
            average=self.average.state_dict(),
            optimiser=self.optimiser.state_dict(),
            batches_done=self.batches_done,
            seconds_spent=self.seconds,
            settings=self.settings.as_dict(),
        ).write(self.folder)

    def _plan(self) -> BatchPlan:
        s = self.settings
        framing = Framing(s.width_px, s.height_px, s.scale_range)
        return BatchPlan(s.seed, s.batch_size, framing, Recipe())

    def _step(self, network: nn.Module, batch: Batch) -> Losses:
        self.network.train()
        batch = batch.to(self.device)
        losses = detection_losses(network(batch.network_input()), batch.targets, self.cells)
        s = self.settings
        rate = learning_rate(s.learning_rate, s.warm_up_batches, self.batches_done, self.progress)
        descend(self.network, self.optimiser, losses.total, rate, MAX_GRADIENT_NORM)
        self.average.update(self.network)
        self.batches_done += 1
        return losses


class ProgressReport:
    """A line now and then: how far, losses since the last line, speed, time left."""

    def __init__(self, training: Training) -> None:
        self.training = training
        self.last_said = time.monotonic()
        self.first_batch, self.first_progress = training.batches_done, training.progress
        self.since: list[Losses] = []

    def add(self, losses: Losses) -> None:
        self.since.append(losses)
        if time.monotonic() - self.last_said >= PROGRESS_SECONDS:
            self.say()

    def say(self) -> None:
        if not self.since:
            return
        training, count = self.training, len(self.since)
        parts = ("score", "overlap", "reach")
        mean = {part: sum(getattr(one, part) for one in self.since) / count for part in parts}
        speed = count * training.settings.batch_size / max(time.monotonic() - self.last_said, 1e-9)
        here = time.monotonic() - training.began
        gained = max(training.progress - self.first_progress, 1e-9)
        left_minutes = max(0.0, (1 - training.progress) * here / gained / 60)
        losses = "  ".join(f"{part} {value:.3f}" for part, value in mean.items())
        images = training.batches_done * training.settings.batch_size
        training.say(
            f"{100 * min(training.progress, 1):5.1f} %  {images} images  {losses}  "
            f"{speed:.1f} images/s  {left_minutes:.1f} min left"
        )
        self.since, self.last_said = [], time.monotonic()
