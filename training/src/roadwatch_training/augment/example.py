"""One training example on its way through the augmentation."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

# Boxes smaller than this in the network's input are neither sought nor held against it, pixels.
MIN_SOUGHT_SIDE_PX = 8.0
MIN_SOUGHT_WIDTH_PX = 4.0
# An object of which less than this share is left in the picture is not sought.
MIN_LEFT_SHARE = 0.35


@dataclass(frozen=True)
class Example:
    """`image` uint8 (height, width, 3) RGB; `rows` float32 (n, 6): class, box edges, 1 if sought."""

    image: np.ndarray
    rows: np.ndarray

    def with_image(self, image: np.ndarray) -> Example:
        return replace(self, image=image)

    @property
    def size_px(self) -> tuple[int, int]:
        """Width and height."""
        return self.image.shape[1], self.image.shape[0]


def empty_rows() -> np.ndarray:
    return np.zeros((0, 6), np.float32)


def placed_rows(rows: np.ndarray, scale: tuple[float, float], shift: tuple[float, float]) -> np.ndarray:
    """Rows with boxes at x * scale + shift."""
    placed = rows.copy()
    placed[:, 1:5:2] = rows[:, 1:5:2] * scale[0] + shift[0]
    placed[:, 2:5:2] = rows[:, 2:5:2] * scale[1] + shift[1]
    return placed


def clipped_rows(rows: np.ndarray, left: float, top: float, right: float, bottom: float) -> np.ndarray:
    """Rows clipped to a window; those outside go, those of which little is left are no longer sought."""
    area = _area(rows)
    clipped = rows.copy()
    clipped[:, 1:5:2] = rows[:, 1:5:2].clip(left, right)
    clipped[:, 2:5:2] = rows[:, 2:5:2].clip(top, bottom)
    left_share = _area(clipped) / np.maximum(area, 1e-6)
    clipped[:, 5] *= left_share >= MIN_LEFT_SHARE
    return clipped[left_share > 0]


def small_unsought(rows: np.ndarray) -> np.ndarray:
    """Rows whose boxes are too small to be told apart are no longer sought."""
    width, height = rows[:, 3] - rows[:, 1], rows[:, 4] - rows[:, 2]
    kept = rows.copy()
    kept[:, 5] *= (np.maximum(width, height) >= MIN_SOUGHT_SIDE_PX) & (width >= MIN_SOUGHT_WIDTH_PX)
    return kept


def _area(rows: np.ndarray) -> np.ndarray:
    return np.maximum(rows[:, 3] - rows[:, 1], 0) * np.maximum(rows[:, 4] - rows[:, 2], 0)
