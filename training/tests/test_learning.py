"""Training learns, stops, resumes and exports."""

from __future__ import annotations

import itertools
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch

from roadwatch_training.augment.geometry import Framing
from roadwatch_training.augment.recipe import Recipe
from roadwatch_training.batches import BatchPlan, batches
from roadwatch_training.cli import main
from roadwatch_training.errors import TrainingError
from roadwatch_training.export import export
from roadwatch_training.exported import read_exported, settle_normalisation
from roadwatch_training.images import ImageStore, read_rgb
from roadwatch_training.inference import Detector, letterboxed
from roadwatch_training.labels import read_folder
from roadwatch_training.losses import detection_losses
from roadwatch_training.network import Cells, DecodedNetwork, DetectorNetwork, NetworkShape
from roadwatch_training.scoring import Scored, Tally, add_image
from roadwatch_training.settings import Settings
from roadwatch_training.trainer import Training

TINY = NetworkShape(stem=8, stages=(16, 24, 32, 48), depths=(1, 1, 1, 1), pyramid=24)
CALM = Recipe(mosaic=0, pasted=0, blots=0, blended=0, texture_only=0, untouched=1)


@pytest.fixture(scope="module")
def learnt(toy_folder: Path) -> DetectorNetwork:
    """A tiny network that has seen a dozen pictures over and over."""
    torch.manual_seed(0)
    store = ImageStore.load(read_folder(toy_folder))
    framing = Framing(192, 128, (0.9, 1.1))
    made = batches(store, BatchPlan(5, 8, framing, CALM), first=0, workers=0)
    network = DetectorNetwork(TINY).to(memory_format=torch.channels_last)
    cells = Cells.of_input(192, 128)
    steps = 90
    optimiser = torch.optim.AdamW(network.parameters(), 5e-3)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimiser, 5e-3, total_steps=steps)
    for _ in range(steps):
        batch = next(made)
        losses = detection_losses(network(batch.network_input()), batch.targets, cells)
        optimiser.zero_grad()
        losses.total.backward()
        optimiser.step()
        schedule.step()
    return network


def test_a_handful_of_pictures_is_learnt_and_survives_the_export(
    learnt: DetectorNetwork, toy_folder: Path, tmp_path: Path
) -> None:
    export(learnt, tmp_path / "toy.onnx", {})
    detector = Detector(tmp_path / "toy.onnx")
    tally = Tally()
    for image in read_folder(toy_folder):
        detections = detector.detect(read_rgb(image.path), 0.25)
        add_image(tally, detections, image.objects, Scored(classes=frozenset({"car"})))
    assert tally.objects > 50
    assert tally.recall(0.25) >= 0.9
    assert tally.precision(0.25) >= 0.9


def test_the_exported_graph_computes_what_the_network_does(learnt: DetectorNetwork, tmp_path: Path) -> None:
    export(learnt, tmp_path / "toy.onnx", {})
    detector = Detector(tmp_path / "toy.onnx")
    images = np.random.default_rng(0).random((2, 3, 384, 640), np.float32)
    found = detector.session.run(None, {detector.input_name: images})[0]
    with torch.no_grad():
        expected = DecodedNetwork(learnt.eval(), 640, 384)(torch.from_numpy(images)).numpy()
    assert found.shape == (2, 10, 5040)
    # Filters are stored with 16 bits: a little of a pixel, less of a score.
    np.testing.assert_allclose(found[:, :4], expected[:, :4], atol=0.5)
    np.testing.assert_allclose(found[:, 4:], expected[:, 4:], atol=5e-3)
    assert detector.class_names == ("person", "bicycle", "car", "motorcycle", "bus", "truck")


def test_a_resumed_training_ends_where_an_uninterrupted_one_does(toy_folder: Path, tmp_path: Path) -> None:
    store = ImageStore.load(read_folder(toy_folder))
    settings = Settings(width="small", width_px=64, height_px=64, batch_size=2, images=12, workers=0)
    whole = Training(settings, store, tmp_path / "whole", print)
    whole.run()
    first = Training(settings, store, tmp_path / "parts", print)
    plan = batches(store, first._plan(), 0, 0)
    for _ in range(3):
        first._step(first.network, next(plan))
    first.save()
    second = Training(settings, store, tmp_path / "parts", print)
    second.resume()
    second.run()
    for name, value in whole.average.network.state_dict().items():
        torch.testing.assert_close(value, second.average.network.state_dict()[name], msg=name)


def test_a_training_may_begin_with_the_weights_of_another(toy_folder: Path, tmp_path: Path) -> None:
    store = ImageStore.load(read_folder(toy_folder))
    settings = Settings(width="small", width_px=64, height_px=64, batch_size=2, images=4, workers=0)
    first = Training(settings, store, tmp_path / "first", print)
    first.run()
    second = Training(replace(settings, seed=2), store, tmp_path / "second", print)
    second.start_from(tmp_path / "first")
    for name, value in first.average.network.state_dict().items():
        torch.testing.assert_close(value, second.network.state_dict()[name], msg=name)
    other = Training(replace(settings, width="medium"), store, tmp_path / "third", print)
    with pytest.raises(TrainingError, match="width small, not medium"):
        other.start_from(tmp_path / "first")


def test_the_command_trains_exports_and_scores(
    toy_folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture
) -> None:
    out = tmp_path / "run"
    words = ["detector", "--data", str(toy_folder), "--out", str(out)]
    quick = ["--width", "small", "--window", "96x64", "--batch", "2", "--images", "4", "--threads", "1"]
    assert main([*words, *quick]) == 0
    assert (out / "detector.onnx").stat().st_size < 6_000_000
    assert main(["export", "--run", str(out), "--onnx", str(tmp_path / "again.onnx")]) == 0
    assert (tmp_path / "again.onnx").read_bytes() == (out / "detector.onnx").read_bytes()
    assert main(["score", "--model", str(out / "detector.onnx"), "--data", str(toy_folder)]) == 0
    assert "| 0.25 (asked for) |" in capsys.readouterr().out
    assert main(words) == 1
    assert "--resume" in capsys.readouterr().err


def test_the_letterbox_is_the_daemons() -> None:
    canvas, gain, offset = letterboxed(np.full((540, 960, 3), 200, np.uint8), 640, 384)
    assert gain == pytest.approx(2 / 3)
    assert offset == (0, 12)
    assert (canvas[:12] == 114).all() and (canvas[12:372] == 200).all() and (canvas[372:] == 114).all()


def test_training_goes_on_from_an_exported_file(learnt: DetectorNetwork, toy_folder: Path, tmp_path: Path) -> None:
    export(learnt, tmp_path / "toy.onnx", {})
    read = DetectorNetwork(TINY)
    read_exported(tmp_path / "toy.onnx", read)
    store = ImageStore.load(read_folder(toy_folder))
    plan = BatchPlan(5, 8, Framing(192, 128, (0.9, 1.1)), CALM)
    inputs = [batch.network_input() for batch in itertools.islice(batches(store, plan, 0, 0), 12)]
    settle_normalisation(read, inputs)
    with torch.no_grad():
        expected = torch.cat([learnt.eval()(images) for images in inputs])
        found = torch.cat([read.eval()(images) for images in inputs])
        trained_on = torch.cat([read.train()(images) for images in inputs])
    # Filters were stored with 16 bits; a batch's own means are near those of a dozen batches.
    assert (found - expected).abs().mean() < 0.01 * expected.abs().mean()
    assert (trained_on - expected).abs().mean() < 0.15 * expected.abs().mean()


def test_an_exported_file_of_another_width_is_refused(learnt: DetectorNetwork, tmp_path: Path) -> None:
    export(learnt, tmp_path / "toy.onnx", {})
    with pytest.raises(TrainingError, match="another network"):
        read_exported(tmp_path / "toy.onnx", DetectorNetwork(NetworkShape()))
