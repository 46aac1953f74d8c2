"""Which part of a picture is seen, how large, and which way round."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from .example import Example, clipped_rows, placed_rows

# What networks are fed beside the picture.
PADDING_GREY = 114
# Widths over heights vary by this factor: lenses and mountings differ.
ASPECT_JITTER = 0.12
# Bilinear most often: it is what the daemon's letterbox does.
INTERPOLATIONS = (cv2.INTER_LINEAR, cv2.INTER_LINEAR, cv2.INTER_AREA, cv2.INTER_CUBIC)


@dataclass(frozen=True)
class Framing:
    """How a picture is cut: output pixels, and the range of output pixels per picture pixel."""

    width_px: int
    height_px: int
    scale_range: tuple[float, float]
    # Share of cuts made around an object; the others lie anywhere.
    object_share: float = 0.7


def random_cut(image: np.ndarray, rows: np.ndarray, framing: Framing, rng: np.random.Generator) -> Example:
    """A random window of a picture at a random scale, padded where the picture ends."""
    low, high = np.log(framing.scale_range)
    scale = float(np.exp(rng.uniform(low, high)))
    stretch = float(np.exp(rng.uniform(-ASPECT_JITTER, ASPECT_JITTER)))
    scale_x, scale_y = scale * stretch**0.5, scale / stretch**0.5
    source = (framing.width_px / scale_x, framing.height_px / scale_y)
    corner = _window_corner(image, rows, source, framing.object_share, rng)
    cut = _resampled(image, corner, (scale_x, scale_y), framing, rng)
    placed = placed_rows(rows, (scale_x, scale_y), (-corner[0] * scale_x, -corner[1] * scale_y))
    return Example(cut, clipped_rows(placed, 0, 0, framing.width_px, framing.height_px))


def _window_corner(
    image: np.ndarray,
    rows: np.ndarray,
    source: tuple[float, float],
    object_share: float,
    rng: np.random.Generator,
) -> tuple[int, int]:
    """Top left of the window, picture pixels; outside the picture only where the window is larger."""
    sought = rows[rows[:, 5] > 0]
    around = len(sought) > 0 and rng.random() < object_share
    box = sought[rng.integers(len(sought))] if around else None
    corner = []
    for axis, (window, picture) in enumerate(zip(source, (image.shape[1], image.shape[0]))):
        slack = picture - window
        if slack <= 0:
            corner.append(round(rng.uniform(slack, 0)))
            continue
        offset = rng.uniform(0, slack)
        if box is not None:
            centre = (box[1 + axis] + box[3 + axis]) / 2
            offset = min(max(centre - window * rng.uniform(0.15, 0.85), 0), slack)
        corner.append(round(offset))
    return corner[0], corner[1]


def _resampled(
    image: np.ndarray,
    corner: tuple[int, int],
    scale: tuple[float, float],
    framing: Framing,
    rng: np.random.Generator,
) -> np.ndarray:
    """The window resized as a whole, then laid on grey, so that its borders blend as the letterbox's do."""
    left, top = max(corner[0], 0), max(corner[1], 0)
    right = min(corner[0] + round(framing.width_px / scale[0]), image.shape[1])
    bottom = min(corner[1] + round(framing.height_px / scale[1]), image.shape[0])
    at_x, at_y = round((left - corner[0]) * scale[0]), round((top - corner[1]) * scale[1])
    width = min(max(round((right - left) * scale[0]), 1), framing.width_px - at_x)
    height = min(max(round((bottom - top) * scale[1]), 1), framing.height_px - at_y)
    method = INTERPOLATIONS[rng.integers(len(INTERPOLATIONS))]
    resized = cv2.resize(image[top:bottom, left:right], (width, height), interpolation=method)
    if (width, height) == (framing.width_px, framing.height_px):
        return resized
    canvas = np.full((framing.height_px, framing.width_px, 3), PADDING_GREY, np.uint8)
    canvas[at_y : at_y + height, at_x : at_x + width] = resized
    return canvas


def mirrored(example: Example) -> Example:
    """Left and right exchanged."""
    rows = example.rows.copy()
    width = example.size_px[0]
    rows[:, 1], rows[:, 3] = width - example.rows[:, 3], width - example.rows[:, 1]
    return Example(np.ascontiguousarray(example.image[:, ::-1]), rows)


def mosaic(parts: list[Example], rng: np.random.Generator) -> Example:
    """Four examples of one size, a quarter of each, around a random point."""
    width, height = parts[0].size_px
    x, y = round(width * rng.uniform(0.3, 0.7)), round(height * rng.uniform(0.3, 0.7))
    canvas = np.empty_like(parts[0].image)
    rows = []
    for part, (left, right) in zip(parts, ((0, x), (x, width), (0, x), (x, width))):
        top, bottom = (0, y) if len(rows) < 2 else (y, height)
        canvas[top:bottom, left:right] = part.image[top:bottom, left:right]
        rows.append(clipped_rows(part.rows, left, top, right, bottom))
    return Example(canvas, np.concatenate(rows))
