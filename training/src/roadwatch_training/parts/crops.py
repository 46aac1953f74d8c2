"""One vehicle's normalised crop (docs/method.md, section 4).

Positions count from pixel centres, as cameras' cx and cy do; boxes are edges.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

# Left, top, right, bottom.
Box = tuple[float, float, float, float]


@dataclass(frozen=True)
class CropPlacement:
    """Where the pixels `source_px` (left, top, right, bottom) of an image lie in its crop."""

    source_px: tuple[int, int, int, int]
    left_px: int
    top_px: int
    width_px: int
    height_px: int

    def to_crop(self, points_px: np.ndarray) -> np.ndarray:
        """Positions (..., 2) in the image as positions in the crop."""
        return (points_px + 0.5 - self._corner()) * self._scale() + self._place() - 0.5

    def to_image(self, points_px: np.ndarray) -> np.ndarray:
        """Positions (..., 2) in the crop as positions in the image."""
        return (points_px + 0.5 - self._place()) / self._scale() + self._corner() - 0.5

    def _corner(self) -> np.ndarray:
        return np.array(self.source_px[:2], float)

    def _place(self) -> np.ndarray:
        return np.array([self.left_px, self.top_px], float)

    def _scale(self) -> np.ndarray:
        left, top, right, bottom = self.source_px
        return np.array([self.width_px / (right - left), self.height_px / (bottom - top)])


def placement(box_px: Box, image_size_px: tuple[int, int], side_px: int) -> CropPlacement | None:
    """The box's place in a square crop; None where the box, clipped to the image, holds no pixel."""
    left, top = (max(round(edge), 0) for edge in box_px[:2])
    right, bottom = (min(round(edge), size) for edge, size in zip(box_px[2:], image_size_px))
    width, height = right - left, bottom - top
    if width < 1 or height < 1:
        return None
    source = (left, top, right, bottom)
    scaled_height = max(round(height * side_px / width), 1)
    if scaled_height <= side_px:
        return CropPlacement(source, 0, (side_px - scaled_height) // 2, side_px, scaled_height)
    scaled_width = max(round(width * side_px / height), 1)
    return CropPlacement(source, (side_px - scaled_width) // 2, 0, scaled_width, side_px)


def crop(
    image: np.ndarray, place: CropPlacement, side_px: int, interpolation: int = cv2.INTER_LINEAR
) -> np.ndarray:
    """The crop, (side, side, channels) uint8, black beside the vehicle."""
    left, top, right, bottom = place.source_px
    size = (place.width_px, place.height_px)
    resized = cv2.resize(image[top:bottom, left:right], size, interpolation=interpolation)
    canvas = np.zeros((side_px, side_px, image.shape[2]), np.uint8)
    canvas[place.top_px : place.top_px + size[1], place.left_px : place.left_px + size[0]] = resized
    return canvas
