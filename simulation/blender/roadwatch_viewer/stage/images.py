"""The cameras' images: behind Blender's cameras in its window, and under rendered boxes in pictures."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import bpy
import numpy as np

from ..dataset import CameraImages
from ..errors import ViewerError
from .keyframes import Recorder

PATH = "background_images[0].image_user.frame_offset"


def show_behind(camera: bpy.types.Object, images: CameraImages, stamps_ns: Mapping[float, int]) -> None:
    """Puts the camera's images behind it; `stamps_ns` says the scene's stamp at each frame of Blender's."""
    lens = camera.data
    first = bpy.data.images.load(str(images.path(images.frames[0]).resolve()))
    first.source = "SEQUENCE"
    lens.show_background_images = True
    behind = lens.background_images.new()
    behind.image, behind.alpha, behind.frame_method = first, 1.0, "STRETCH"
    user = behind.image_user
    # A sequence one image long never advances by itself: the offset alone says which image is seen.
    user.frame_start, user.frame_duration, user.use_auto_refresh = 1, 1, True
    recorder = Recorder()
    for frame, stamp_ns in stamps_ns.items():
        recorder.note_step(lens, PATH, (float(images.nearest(stamp_ns) - 1),), frame=frame)
    recorder.write()


def lay_over(picture: Path, image: Path) -> None:
    """Lays a rendered picture with a transparent ground over a camera's image, in place."""
    over, size = _read(picture, None)
    under, _ = _read(image, size)
    alpha = over[..., 3:]
    colour = over[..., :3] * alpha + under[..., :3] * (1.0 - alpha)
    made = bpy.data.images.new("laid over", *size)
    made.pixels.foreach_set(np.dstack([colour, np.ones_like(alpha)]).astype(np.float32).ravel())
    made.filepath_raw, made.file_format = str(picture), "PNG"
    made.save()
    bpy.data.images.remove(made)


def _read(path: Path, size: tuple[int, int] | None) -> tuple[np.ndarray, tuple[int, int]]:
    """Pixels as stored (h, w, 4), 0 to 1, lowest row first, scaled to `size` where one is given."""
    try:
        image = bpy.data.images.load(str(path.resolve()))
    except RuntimeError as error:
        raise ViewerError(f"cannot read the image {path}: {error}") from error
    if size is not None and tuple(image.size) != size:
        image.scale(*size)
    width, height = image.size
    pixels = np.empty(width * height * 4, dtype=np.float32)
    image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    return pixels.reshape(height, width, 4), (width, height)
