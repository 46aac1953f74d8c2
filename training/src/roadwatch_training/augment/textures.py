"""Pictures of nothing: noise of many scales and dead leaves, as backgrounds and to blend with."""

from __future__ import annotations

import cv2
import numpy as np

LEAVES_RANGE = (12, 70)


def texture(width_px: int, height_px: int, rng: np.random.Generator) -> np.ndarray:
    """A procedural picture, uint8 RGB."""
    maker = dead_leaves if rng.random() < 0.6 else fractal_noise
    return maker(width_px, height_px, rng)


def fractal_noise(width_px: int, height_px: int, rng: np.random.Generator) -> np.ndarray:
    """Coloured noise whose contrast falls with fineness, as in natural pictures."""
    total = np.zeros((height_px, width_px, 3), np.float32)
    persistence = rng.uniform(0.4, 0.9)
    cells, contrast = 2, 1.0
    while cells < width_px:
        rows = max(2, round(cells * height_px / width_px * rng.uniform(0.4, 2.0)))
        coarse = rng.standard_normal((rows, cells, 3), np.float32)
        grey = coarse.mean(2, keepdims=True) * 1.7
        coarse = coarse + (grey - coarse) * np.float32(rng.uniform(0.5, 1.0))
        fine = cv2.resize(coarse, (width_px, height_px), interpolation=cv2.INTER_CUBIC)
        total += np.float32(contrast) * fine
        cells, contrast = cells * 2, contrast * persistence
    total *= rng.uniform(25, 60) / (total.std() + 1e-6)
    total += rng.uniform(50, 200, 3).astype(np.float32)
    return total.clip(0, 255).astype(np.uint8)


def dead_leaves(width_px: int, height_px: int, rng: np.random.Generator) -> np.ndarray:
    """Shapes upon shapes, large ones first: edges, corners and occlusion without objects."""
    canvas = fractal_noise(width_px, height_px, rng)
    count = int(rng.integers(*LEAVES_RANGE))
    sizes = np.sort(height_px * 0.6 * rng.power(0.5, count))[::-1]
    for size in np.maximum(sizes, 3):
        centre = (int(rng.integers(width_px)), int(rng.integers(height_px)))
        colour = tuple(int(c) for c in rng.normal(rng.uniform(30, 220), 25, 3).clip(0, 255))
        _leaf(canvas, centre, float(size), colour, rng)
    return canvas


def _leaf(
    canvas: np.ndarray,
    centre: tuple[int, int],
    size: float,
    colour: tuple[int, ...],
    rng: np.random.Generator,
) -> None:
    kind = rng.integers(4)
    half = (max(1, round(size / 2)), max(1, round(size * rng.uniform(0.15, 1.0))))
    angle = float(rng.uniform(0, 180)) if rng.random() < 0.5 else 0.0
    if kind == 0:
        cv2.ellipse(canvas, centre, half, angle, 0, 360, colour, -1, cv2.LINE_AA)
    elif kind == 1:
        corners = cv2.boxPoints((centre, (2 * half[0], 2 * half[1]), angle))
        cv2.fillConvexPoly(canvas, corners.astype(np.int32), colour, cv2.LINE_AA)
    elif kind == 2:
        corners = np.array(centre) + rng.normal(0, size / 2, (int(rng.integers(3, 7)), 2))
        cv2.fillPoly(canvas, [corners.astype(np.int32)], colour, cv2.LINE_AA)
    else:
        end = (np.array(centre) + rng.normal(0, size * 2, 2)).astype(int)
        cv2.line(canvas, centre, (int(end[0]), int(end[1])), colour, int(rng.integers(1, 6)), cv2.LINE_AA)
