"""Decoded images kept in memory, because decoding a JPEG costs as much as augmenting it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from .errors import TrainingError
from .labels import LabelledImage

# Decoded bytes that may be held; a training machine with less memory takes fewer images.
MAX_STORE_BYTES = 12 * 1024**3


@dataclass(frozen=True)
class ImageStore:
    """All images of one size, RGB uint8 (images, height, width, 3), and their target rows."""

    pixels: np.ndarray
    targets: list[np.ndarray]

    @classmethod
    def load(cls, images: list[LabelledImage]) -> ImageStore:
        """Decodes everything; all images must be of one size."""
        first = read_rgb(images[0].path)
        if len(images) * first.nbytes > MAX_STORE_BYTES:
            raise TrainingError(
                f"{len(images)} images of {first.shape[1]}x{first.shape[0]} need more than "
                f"{MAX_STORE_BYTES / 1024**3:.0f} GiB: give fewer or smaller ones"
            )
        pixels = np.empty((len(images), *first.shape), np.uint8)
        for at, image in enumerate(images):
            decoded = read_rgb(image.path)
            if decoded.shape != first.shape:
                raise TrainingError(f"`{image.path}` is not of the same size as `{images[0].path}`")
            pixels[at] = decoded
        return cls(pixels, [image.target_rows() for image in images])

    def __len__(self) -> int:
        return len(self.pixels)


def read_rgb(path: Path) -> np.ndarray:
    """A picture file as uint8 (height, width, 3), red first."""
    if not path.is_file():
        raise TrainingError(f"`{path}` is named by the labels and does not exist")
    image = cv2.imread(str(path), cv2.IMREAD_COLOR)
    if image is None:
        raise TrainingError(f"`{path}` is not a picture that can be decoded: make the data again")
    return cv2.cvtColor(image, cv2.COLOR_BGR2RGB)
