"""Labels are read, examples are the same for the same number, boxes stay on their objects."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import torch

from roadwatch_training.augment.example import Example, clipped_rows
from roadwatch_training.augment.geometry import Framing, mirrored, mosaic, random_cut
from roadwatch_training.augment.pasting import with_blots, with_pasted
from roadwatch_training.augment.photometric import CHANGES
from roadwatch_training.augment.recipe import Recipe, example
from roadwatch_training.augment.textures import dead_leaves, fractal_noise
from roadwatch_training.errors import TrainingError
from roadwatch_training.images import ImageStore
from roadwatch_training.labels import read_folder


def white_block() -> tuple[np.ndarray, np.ndarray]:
    """One white block on black, and its row."""
    image = np.zeros((180, 320, 3), np.uint8)
    image[60:110, 120:200] = 255
    return image, np.array([[2, 120, 60, 200, 110, 1]], np.float32)


def block_edges(image: np.ndarray) -> np.ndarray:
    """Left, top, right, bottom of what is bright and not padding."""
    rows, columns = np.nonzero(image[..., 0] > 127)
    return np.array([columns.min(), rows.min(), columns.max() + 1, rows.max() + 1])


def test_hidden_objects_are_not_sought_and_unknown_ones_left_out(tmp_path: Path) -> None:
    box = [1.0, 2.0, 30.0, 40.0]
    shown = {"silhouette_px": box, "visible_px": box, "truncated": 0.0}
    objects = [
        {"class": "car", "occluded": 0.1, **shown},
        {"class": "truck", "occluded": 0.8, **shown},
        {"class": "tree", "occluded": 0.0, **shown},
        {"class": "car", "occluded": 1.0, **shown, "visible_px": None},
    ]
    (tmp_path / "labels.jsonl").write_text(json.dumps({"image": "images/0.jpg", "objects": objects}))
    (image,) = read_folder(tmp_path)
    assert [(label.class_number, label.sought) for label in image.objects] == [(2, True), (5, False)]


@pytest.mark.parametrize(
    ("text", "expected"), [(None, "does not exist"), ("", "no lines"), ("{\n", "line 1"), ("{}", "objects")]
)
def test_labels_that_cannot_be_used_say_why(tmp_path: Path, text: str | None, expected: str) -> None:
    if text is not None:
        (tmp_path / "labels.jsonl").write_text(text)
    with pytest.raises(TrainingError, match=expected):
        read_folder(tmp_path)


def test_a_missing_picture_is_named(tmp_path: Path) -> None:
    (tmp_path / "labels.jsonl").write_text(json.dumps({"image": "images/7.jpg", "objects": []}))
    with pytest.raises(TrainingError, match="images/7.jpg"):
        ImageStore.load(read_folder(tmp_path))


@pytest.mark.parametrize("seed", range(40))
def test_boxes_stay_on_their_objects_through_cut_and_mirror(seed: int) -> None:
    rng = np.random.default_rng(seed)
    made = mirrored(random_cut(*white_block(), Framing(256, 160, (0.5, 2.0)), rng))
    if len(made.rows) == 0:
        assert (made.image > 127).sum() == 0
        return
    np.testing.assert_allclose(block_edges(made.image), made.rows[0, 1:5], atol=1.6)


def test_boxes_stay_on_their_objects_in_a_mosaic() -> None:
    rng = np.random.default_rng(1)
    image, rows = white_block()
    made = mosaic([Example(image, rows)] * 4, rng)
    for row in made.rows:
        left, top, right, bottom = row[1:5].round().astype(int)
        assert (made.image[top:bottom, left:right] > 127).mean() > 0.95


@pytest.mark.parametrize("seed", range(10))
def test_a_pasted_object_lies_under_its_box(seed: int) -> None:
    image, rows = white_block()
    empty = Example(np.zeros_like(image), np.zeros((0, 6), np.float32))
    made = with_pasted(empty, Example(image, rows), np.random.default_rng(seed))
    assert len(made.rows) == 1
    np.testing.assert_allclose(block_edges(made.image), made.rows[0, 1:5], atol=2.5)


def test_an_object_cut_to_a_rest_is_not_sought() -> None:
    rows = np.array([[2, 0, 0, 100, 100, 1], [2, 90, 0, 190, 100, 1], [2, 300, 0, 310, 9, 1]], np.float32)
    clipped = clipped_rows(rows, 0, 0, 100, 100)
    assert clipped[:, 5].tolist() == [1, 0]


@pytest.mark.parametrize("change", [change for _, change in CHANGES])
def test_every_photometric_change_keeps_shape_and_depends_on_its_seed_only(change) -> None:  # noqa: ANN001
    image = dead_leaves(96, 64, np.random.default_rng(2))
    first, second = (change(image, np.random.default_rng(9)) for _ in range(2))
    assert first.shape == image.shape and first.dtype == np.uint8
    np.testing.assert_array_equal(first, second)


def test_textures_have_contrast() -> None:
    for maker in (dead_leaves, fractal_noise):
        assert maker(128, 96, np.random.default_rng(4)).std() > 8


def test_blots_unseek_what_they_cover() -> None:
    image, rows = white_block()
    rows[0, 1:5] = 150, 80, 153, 83
    blotted = (with_blots(Example(image, rows), np.random.default_rng(seed)) for seed in range(80))
    unsought = sum(made.rows[0, 5] == 0 for made in blotted)
    assert 0 < unsought < 80


def test_example_number_n_is_always_the_same(toy_folder: Path) -> None:
    store = ImageStore.load(read_folder(toy_folder))
    framing = Framing(128, 96, (0.5, 1.2))
    for number in range(20):
        draws = (np.random.default_rng((1, number)) for _ in range(2))
        first, second = (example(store, framing, Recipe(), rng) for rng in draws)
        np.testing.assert_array_equal(first.image, second.image)
        np.testing.assert_array_equal(first.rows, second.rows)
        assert first.image.shape == (96, 128, 3) and torch.from_numpy(first.rows).isfinite().all()
