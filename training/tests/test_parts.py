"""Crops map back, examples keep components on their places, heads learn, export, and are scored."""

from __future__ import annotations

import json
import math
from pathlib import Path

import cv2
import numpy as np
import onnx
import pytest
import torch

from roadwatch_training.cli import main
from roadwatch_training.errors import TrainingError
from roadwatch_training.export import export as export_detector
from roadwatch_training.network import DetectorNetwork, NetworkShape
from roadwatch_training.parts.angles import (
    BIN_RAD,
    bin_shares,
    likely_angle,
    observation_angle,
    probability_at,
)
from roadwatch_training.parts.batches import PartsBatches, PartsPlan
from roadwatch_training.parts.components import COMPONENTS, MIRRORED
from roadwatch_training.parts.crops import crop, placement
from roadwatch_training.parts.export import HeadNotes, export
from roadwatch_training.parts.features import FrozenFeatures
from roadwatch_training.parts.inference import PartsModel, peaks
from roadwatch_training.parts.losses import PartsTargets, parts_losses, target_heat
from roadwatch_training.parts.network import DecodedHead, PartsHead
from roadwatch_training.parts.recipe import CHANGES, Recipe, example, mirrored, plain_example
from roadwatch_training.parts.scoring import best_thresholds, component_scores, facing_score, find_all
from roadwatch_training.parts.settings import PartsSettings
from roadwatch_training.parts.trainer import PartsTraining
from roadwatch_training.parts.vehicles import Vehicle, is_held_out, read_vehicles

NOTES = HeadNotes((0.4,) * len(COMPONENTS), "none")
TINY = NetworkShape(stem=8, stages=(16, 24, 32, 48), depths=(1, 1, 1, 1), pyramid=24)
SIDE = 64


def toy_entry(rng: np.random.Generator, image: np.ndarray, left: int) -> dict:
    """Draws a grey block that goes left or right, lamps at its ends, and describes it."""
    top, width, height = int(rng.integers(40, 90)), int(rng.integers(70, 110)), int(rng.integers(36, 50))
    goes_left = bool(rng.random() < 0.5)
    cv2.rectangle(image, (left, top), (left + width - 1, top + height - 1), (120, 120, 120), -1)
    front, rear = (left + 8, left + width - 9) if goes_left else (left + width - 9, left + 8)
    middle = top + height // 2
    cv2.circle(image, (front, middle), 5, (255, 255, 255), -1)
    cv2.circle(image, (rear, middle), 5, (20, 20, 230), -1)
    box = [left, top, left + width, top + height]
    side = "left" if goes_left else "right"
    parts = [
        {"name": f"headlamp_{side}", "x_px": front, "y_px": middle, "visible": True, "box_px": None},
        {"name": f"taillamp_{side}", "x_px": rear, "y_px": middle, "visible": True, "box_px": None},
        {"name": "not a component", "x_px": 0, "y_px": 0, "visible": True, "box_px": None},
    ]
    return {
        "class": "car", "silhouette_px": box, "visible_px": box, "occluded": 0.0, "truncated": 0.0,
        "parts": parts, "yaw_base_rad": math.pi / 2 * (1 if goes_left else -1),
        "center_base_m": [20.0, 0.0, 0.8],
    }  # fmt: skip


def write_toy_pictures(folder: Path, count: int, seed: int) -> Path:
    rng = np.random.default_rng(seed)
    (folder / "images").mkdir(parents=True)
    lines = []
    for number in range(count):
        image = np.full((180, 480, 3), rng.integers(30, 70, 3), np.uint8)
        objects = [toy_entry(rng, image, left) for left in (20, 180, 330)]
        name = f"images/{number * 24:06d}.jpg"
        cv2.imwrite(str(folder / name), image)
        lines.append(json.dumps({"image": name, "position_m": [0.0, 0.0, 1.5], "objects": objects}))
    (folder / "labels.jsonl").write_text("\n".join(lines) + "\n")
    return folder


@pytest.fixture(scope="module")
def pictures(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_toy_pictures(tmp_path_factory.mktemp("parts") / "pictures", count=20, seed=2)


@pytest.fixture(scope="module")
def detector(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A detector with random weights: even its features tell white from red."""
    torch.manual_seed(1)
    path = tmp_path_factory.mktemp("detector") / "detector.onnx"
    export_detector(DetectorNetwork(TINY), path, {})
    return path


@pytest.fixture(scope="module")
def vehicle(pictures: Path) -> Vehicle:
    return read_vehicles(pictures).trained_on[0]


@pytest.mark.parametrize("box", [(3.2, 4.0, 90.7, 40.0), (5.0, 5.0, 12.0, 55.0), (-20.0, 30.0, 200.0, 90.0)])
def test_positions_in_a_crop_map_back_exactly(box: tuple[float, float, float, float]) -> None:
    place = placement(box, (100, 60), 800)
    assert place is not None
    points = np.array([[0.0, 0.0], [50.5, 20.25], [99.0, 59.0]])
    np.testing.assert_allclose(place.to_image(place.to_crop(points)), points, atol=1e-9)


def test_crops_are_the_methods() -> None:
    wide = placement((10, 10, 110, 43), (960, 540), 192)
    assert wide is not None and (wide.width_px, wide.height_px, wide.left_px, wide.top_px) == (192, 63, 0, 64)
    tall = placement((10, 10, 43, 110), (960, 540), 192)
    assert tall is not None and (tall.width_px, tall.height_px, tall.left_px, tall.top_px) == (63, 192, 64, 0)
    flat = placement((0, 0, 960, 1), (960, 540), 192)
    assert flat is not None and flat.height_px == 1 and flat.top_px == 95
    assert placement((50, 50, 50.2, 80), (960, 540), 192) is None
    assert placement((-40, 10, -1, 60), (960, 540), 192) is None
    made = crop(np.full((540, 960, 3), 200, np.uint8), wide, 192)
    assert (made[64:127] == 200).all() and (made[:64] == 0).all() and (made[127:] == 0).all()


def test_angles_say_what_is_seen() -> None:
    ahead, camera = [20.0, 0.0, 0.8], [0.0, 0.0, 1.5]
    assert observation_angle(0.0, ahead, camera) == 0
    assert abs(observation_angle(math.pi, ahead, camera)) == pytest.approx(math.pi)
    assert observation_angle(math.pi / 2, [0.0, 20.0, 0.8], camera) == pytest.approx(0)


def test_bin_shares_peak_at_the_angle() -> None:
    angles = np.linspace(-math.pi, math.pi, 33)[:-1]
    shares = bin_shares(torch.from_numpy(angles), math.radians(16)).numpy()
    np.testing.assert_allclose(shares.sum(1), 1, atol=1e-6)
    off = np.abs((likely_angle(shares) - angles + math.pi) % (2 * math.pi) - math.pi)
    assert off.max() <= BIN_RAD / 2 + 1e-6
    assert (probability_at(shares, angles) > probability_at(shares, angles + math.pi)).all()


def test_the_centroid_gives_back_the_component() -> None:
    points = torch.from_numpy(np.random.default_rng(3).uniform(4, SIDE - 5, (5, len(COMPONENTS), 2)))
    targets = PartsTargets(points, torch.ones(5, len(COMPONENTS), dtype=torch.bool), torch.zeros(5))
    found, scores = peaks(target_heat(targets, SIDE // 8).numpy(), 8)
    np.testing.assert_allclose(found, points, atol=1e-6)
    np.testing.assert_allclose(scores, 1)


def test_every_tenth_group_of_pictures_is_held_out(pictures: Path) -> None:
    assert not is_held_out("images/000215.jpg") and is_held_out("images/000216.jpg")
    sets = read_vehicles(pictures)
    assert (len(sets.trained_on), len(sets.held_out)) == (54, 6)


@pytest.mark.parametrize(("text", "expected"), [(None, "not exist"), ("{\n", "line 1"), ("{}\n", "image")])
def test_labels_that_cannot_be_used_say_why(tmp_path: Path, text: str | None, expected: str) -> None:
    if text is not None:
        (tmp_path / "labels.jsonl").write_text(text)
    with pytest.raises(TrainingError, match=expected):
        read_vehicles(tmp_path)


def test_hidden_cut_and_small_vehicles_are_left_out(tmp_path: Path) -> None:
    shown = toy_entry(np.random.default_rng(1), np.zeros((180, 480, 3), np.uint8), 20)
    hidden, small = ({"occluded": 0.9}, {"visible_px": None}), {"visible_px": [0, 0, 60, 9]}
    others = (*hidden, small, {"truncated": 0.9}, {"class": "person"})
    objects = [{**shown, **other} for other in others]
    line = {"image": "images/0.jpg", "position_m": [0, 0, 1], "objects": objects}
    (tmp_path / "labels.jsonl").write_text(json.dumps(line) + "\n")
    assert read_vehicles(tmp_path).trained_on == []


CALM = Recipe(covered=0, blended=0, untouched=1)


@pytest.mark.parametrize("seed", range(30))
def test_components_stay_on_their_places(vehicle: Vehicle, seed: int) -> None:
    made = example(vehicle, 192, CALM, np.random.default_rng(seed))
    for name, is_there in (("headlamp", lambda p: p.min() > 190), ("taillamp", lambda p: p[0] > p[2] + 80)):
        for at in (COMPONENTS.index(f"{name}_left"), COMPONENTS.index(f"{name}_right")):
            if made.visible[at]:
                x, y = made.points_px[at].round().astype(int)
                assert is_there(made.crop[y, x].astype(int))


def test_a_mirrored_example_is_of_the_mirrored_vehicle(vehicle: Vehicle) -> None:
    made = plain_example(vehicle, 192)
    assert made is not None
    once = mirrored(made)
    assert once.angle_rad == -made.angle_rad
    lamps = [COMPONENTS.index(f"headlamp_{side}") for side in ("left", "right")]
    assert made.visible[lamps].tolist() == once.visible[lamps[::-1]].tolist()
    twice = mirrored(once)
    np.testing.assert_array_equal(twice.crop, made.crop)
    np.testing.assert_allclose(twice.points_px[made.visible], made.points_px[made.visible])
    assert COMPONENTS[MIRRORED[COMPONENTS.index("plate_rear")]] == "plate_rear"


@pytest.mark.parametrize("change", [change for _, change in CHANGES])
@pytest.mark.parametrize("size", [(192, 8), (8, 192)])
def test_every_change_works_on_the_narrowest_window(change, size: tuple[int, int]) -> None:  # noqa: ANN001
    rng = np.random.default_rng(4)
    image = rng.integers(0, 256, (size[1], size[0], 3)).astype(np.uint8)
    changed = change(image, rng)
    assert changed.shape == image.shape and changed.dtype == np.uint8


def test_example_number_n_is_always_the_same(pictures: Path) -> None:
    vehicles = read_vehicles(pictures).trained_on
    first, second = (PartsBatches(vehicles, PartsPlan(1, 16, SIDE, Recipe())).batch(3) for _ in range(2))
    np.testing.assert_array_equal(first.crops, second.crops)
    torch.testing.assert_close(first.targets.points_px, second.targets.points_px)
    assert first.targets.points_px.isfinite().all()


def test_a_perfect_head_loses_nothing() -> None:
    points = torch.full((2, len(COMPONENTS), 2), 19.5)
    visible = torch.arange(2 * len(COMPONENTS)).reshape(2, -1) % 2 == 0
    targets = PartsTargets(points, visible, torch.tensor([0.3, -2.0]))
    heat = torch.logit(target_heat(targets, SIDE // 8), eps=1e-6)
    facing = bin_shares(targets.angles_rad, math.radians(16)).log()
    assert parts_losses(heat, facing, targets).total < 1e-3
    assert parts_losses(-heat, -facing, targets).total > 1


def test_the_exported_head_computes_what_the_network_does(detector: Path, tmp_path: Path) -> None:
    torch.manual_seed(0)
    features = FrozenFeatures(detector)
    head = PartsHead(features.channels(), SIDE)
    export(head, features, SIDE, tmp_path / "head.onnx", NOTES)
    model = PartsModel(detector, tmp_path / "head.onnx")
    crops = np.random.default_rng(0).integers(0, 256, (3, SIDE, SIDE, 3)).astype(np.uint8)
    found = model.find(crops)
    with torch.no_grad():
        maps = [torch.from_numpy(one) for one in features.of(crops)]
        heat, facing = DecodedHead(head.eval())(*maps)
    np.testing.assert_allclose(found.facing, facing, atol=2e-3)
    np.testing.assert_allclose(found.scores, heat.amax((2, 3)), atol=2e-3)
    assert model.components == COMPONENTS and model.side_px == SIDE


def test_a_head_of_another_detector_is_refused(detector: Path, tmp_path: Path) -> None:
    features = FrozenFeatures(detector)
    export(PartsHead(features.channels(), SIDE), features, SIDE, tmp_path / "head.onnx", NOTES)
    export_detector(DetectorNetwork(TINY), tmp_path / "other.onnx", {})
    with pytest.raises(TrainingError, match="another detector"):
        PartsModel(tmp_path / "other.onnx", tmp_path / "head.onnx")
    with pytest.raises(TrainingError, match="no head"):
        PartsModel(detector, detector)


def test_a_detector_that_is_not_known_asks_for_its_tensors(detector: Path, tmp_path: Path) -> None:
    model = onnx.load(detector)
    for node in model.graph.node:
        for names in (node.input, node.output):
            names[:] = [name.replace("network_backbone", "renamed") for name in names]
    onnx.save(model, tmp_path / "unknown.onnx")
    with pytest.raises(TrainingError, match="--tensors"):
        FrozenFeatures(tmp_path / "unknown.onnx")


def test_a_head_learns_lamps_and_headings(pictures: Path, detector: Path, tmp_path: Path) -> None:
    sets = read_vehicles(pictures)
    settings = PartsSettings(side_px=SIDE, batch_size=16, crops=4800, workers=0)
    features = FrozenFeatures(detector)
    training = PartsTraining(settings, features, lambda _: None, CALM)
    trained = training.run(sets.trained_on)
    export(trained.head, features, SIDE, tmp_path / "head.onnx", NOTES)
    examples = [made for vehicle in sets.held_out if (made := plain_example(vehicle, SIDE))]
    found = find_all(PartsModel(detector, tmp_path / "head.onnx"), examples)
    facing = facing_score(found.facing, np.array([made.angle_rad for made in examples]))
    assert facing.near == 1 and facing.flipped == 0 and facing.front_or_back == 1
    scores = component_scores(found, examples, COMPONENTS, best_thresholds(found, examples))
    lamps = [one for one in scores if one.seen]
    assert lamps and all(one.recall == 1 and one.precision == 1 for one in lamps)


def test_the_command_trains_and_scores(
    pictures: Path, detector: Path, tmp_path: Path, capsys: pytest.CaptureFixture
) -> None:
    out = tmp_path / "head"
    words = ["--detector", str(detector), "--data", str(pictures)]
    quick = ["--out", str(out), "--side", "64", "--batch", "4", "--crops", "8", "--workers", "0"]
    assert main(["parts", *words, *quick]) == 0
    assert "| simulated | 6 |" in capsys.readouterr().out
    assert main(["score-parts", *words, "--head", str(out / "head.onnx")]) == 0
    assert "| headlamp_left |" in capsys.readouterr().out
    assert main(["parts", *words, "--out", str(out), "--side", "100"]) == 1
    assert "multiple of 32" in capsys.readouterr().err
