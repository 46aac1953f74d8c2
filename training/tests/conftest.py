"""Toy pictures: bright blocks for cars, upright ellipses for people."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

torch = pytest.importorskip("torch", reason="PyTorch is not installed: NOTHING of the training is tested")

import cv2  # noqa: E402
import numpy as np  # noqa: E402

# The exported network's own input size, so that nothing is resized when a toy picture is looked at.
WIDTH_PX, HEIGHT_PX = 640, 384


def toy_picture(rng: np.random.Generator) -> tuple[np.ndarray, list[dict]]:
    """A BGR picture and its objects as `roadwatch-simulate training` writes them."""
    image = np.full((HEIGHT_PX, WIDTH_PX, 3), rng.integers(40, 90, 3), np.uint8)
    objects = []
    for slot in range(12):
        left, top = slot % 6 * 106 + int(rng.integers(4, 30)), slot // 6 * 192 + int(rng.integers(10, 120))
        if rng.random() < 0.7:
            width, height = int(rng.integers(40, 70)), int(rng.integers(24, 40))
            cv2.rectangle(image, (left, top), (left + width - 1, top + height - 1), (30, 40, 220), -1)
            kind = "car"
        else:
            width, height = 20, 50
            middle = (left + 10, top + 25)
            cv2.ellipse(image, middle, (10, 25), 0, 0, 360, (60, 220, 40), -1)
            kind = "person"
        box = [left, top, left + width, top + height]
        objects.append(
            {"class": kind, "label": kind, "box_px": box, "silhouette_px": box, "visible_px": box,
             "occluded": 0.0, "truncated": 0.0}
        )  # fmt: skip
    return image, objects


def write_toy_folder(folder: Path, count: int, seed: int) -> Path:
    """A folder of toy pictures."""
    rng = np.random.default_rng(seed)
    (folder / "images").mkdir(parents=True)
    lines = []
    for number in range(count):
        image, objects = toy_picture(rng)
        name = f"images/{number:06d}.jpg"
        cv2.imwrite(str(folder / name), image)
        lines.append(json.dumps({"image": name, "objects": objects}))
    (folder / "labels.jsonl").write_text("\n".join(lines) + "\n")
    return folder


@pytest.fixture(scope="session")
def toy_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_toy_folder(tmp_path_factory.mktemp("data") / "toy", count=12, seed=3)


@pytest.fixture(scope="session", autouse=True)
def one_thread() -> None:
    """On networks this small a second thread waits more than it works, the more so beside other jobs."""
    torch.set_num_threads(1)
