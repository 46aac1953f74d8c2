"""Objects moved onto other backgrounds and covered in part, so that they are known by themselves."""

from __future__ import annotations

import cv2
import numpy as np

from ..boxes import pairwise_iou_array
from .example import Example
from .textures import texture

# Pasted objects hide less than this of what is there already, as a share of the union.
MAX_PASTE_OVERLAP = 0.05
PASTE_ATTEMPTS = 6
# Taken with the object on every side, share of its size: its shadow and a rim to blend over.
PASTE_MARGIN = 0.12


def with_pasted(example: Example, donor: Example, rng: np.random.Generator) -> Example:
    """Up to three sought objects of the donor set down where nothing is, with soft rims."""
    image, rows = example.image.copy(), example.rows
    sought = donor.rows[donor.rows[:, 5] > 0]
    for row in rng.permutation(sought)[: rng.integers(1, 4)]:
        placed = _free_place(row, rows, example.size_px, rng)
        if placed is None:
            continue
        _blend(image, donor.image, row, placed)
        rows = np.concatenate((rows, placed[None]))
    return Example(image, rows)


def _free_place(
    row: np.ndarray, rows: np.ndarray, size_px: tuple[int, int], rng: np.random.Generator
) -> np.ndarray | None:
    """The row moved, mostly sideways, to where it covers no other; None when that is not found."""
    width, height = row[3] - row[1], row[4] - row[2]
    if width >= size_px[0] * 0.6 or height >= size_px[1] * 0.6:
        return None
    for _ in range(PASTE_ATTEMPTS):
        moved = row.copy()
        left = round(rng.uniform(0, size_px[0] - width)) + row[1] % 1
        top = row[2] + round(rng.normal(0, size_px[1] * 0.08))
        moved[1:5] = left, top, left + width, top + height
        inside = top >= 0 and top + height <= size_px[1] and left + width <= size_px[0]
        overlaps = pairwise_iou_array(moved[None, 1:5], rows[:, 1:5])
        if inside and overlaps.max(initial=0.0) < MAX_PASTE_OVERLAP:
            return moved
    return None


def _blend(image: np.ndarray, donor: np.ndarray, row: np.ndarray, placed: np.ndarray) -> None:
    height, width = image.shape[:2]
    margin = np.array([row[3] - row[1], row[4] - row[2]]) * PASTE_MARGIN + 1
    shift = np.round(placed[1:3] - row[1:3]).astype(int)
    low = np.maximum(np.floor(row[1:3] - margin).astype(int), np.maximum(-shift, 0))
    high = np.ceil(row[3:5] + margin).astype(int)
    high = np.minimum(high, np.minimum([width, height], np.array([width, height]) - shift))
    size = high - low
    if (size < 3).any():
        return
    alpha = np.zeros((size[1], size[0]), np.float32)
    inner = np.maximum(np.round(margin).astype(int) // 2, 1)
    alpha[inner[1] : -inner[1], inner[0] : -inner[0]] = 1.0
    alpha = cv2.GaussianBlur(alpha, (0, 0), max(float(inner.mean()) / 2, 0.6))[..., None]
    patch = donor[low[1] : high[1], low[0] : high[0]].astype(np.float32)
    (left, top), (right, bottom) = low + shift, high + shift
    below = image[top:bottom, left:right]
    image[top:bottom, left:right] = (below + (patch - below) * alpha).astype(np.uint8)


def with_blots(example: Example, rng: np.random.Generator) -> Example:
    """Patches of texture or flat colour anywhere: objects are also known by what is left of them."""
    image = example.image.copy()
    width, height = example.size_px
    for _ in range(rng.integers(1, 5)):
        w, h = (max(4, round(side * rng.uniform(0.03, 0.22))) for side in (width, height))
        x, y = int(rng.integers(width - w)), int(rng.integers(height - h))
        flat = rng.random() < 0.4
        image[y : y + h, x : x + w] = rng.integers(0, 256, 3) if flat else texture(w, h, rng)
    return _judged_after_blots(example, image)


def _judged_after_blots(example: Example, image: np.ndarray) -> Example:
    """Objects that a blot covers for the most part are no longer sought."""
    covered = (image != example.image).any(2).astype(np.float32)
    rows = example.rows.copy()
    for row in rows:
        left, top, right, bottom = row[1:5].round().astype(int)
        window = covered[max(top, 0) : max(bottom, 1), max(left, 0) : max(right, 1)]
        if window.size and window.mean() > 0.5:
            row[5] = 0.0
    return Example(image, rows)


def blended_with_texture(image: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """A picture of nothing shining through (after Hendrycks et al., "PixMix", CVPR 2022)."""
    share = float(rng.uniform(0.1, 0.4))
    return cv2.addWeighted(image, 1 - share, texture(image.shape[1], image.shape[0], rng), share, 0)
