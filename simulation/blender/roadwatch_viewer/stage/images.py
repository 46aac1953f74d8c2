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
    """Puts the camera's images behind it; `stamps_ns` says the scene's stamp at each frame of Blender's.

    Raises ViewerError for a clip that has another number of frames than stamps.
    """
    lens = camera.data
    stored = _load(images.file(images.numbers[0]))
    if images.is_clip:
        _check_length(stored, images)
    else:
        stored.source = "SEQUENCE"
    lens.show_background_images = True
    behind = lens.background_images.new()
    behind.image, behind.alpha, behind.frame_method = stored, 1.0, "STRETCH"
    user = behind.image_user
    # A sequence one image long never advances by itself: the offset alone says which image is seen.
    user.frame_start, user.frame_duration, user.use_auto_refresh = 1, 1, True
    recorder = Recorder()
    for frame, stamp_ns in stamps_ns.items():
        recorder.note_step(lens, PATH, (float(images.nearest(stamp_ns) - 1),), frame=frame)
    recorder.write()


def lay_over(picture: Path, images: CameraImages, number: int) -> None:
    """Lays a rendered picture with a transparent ground over one of a camera's images, in place."""
    over, size = _read(picture, 1, None)
    under, _ = _read(images.file(number), number, size)
    alpha = over[..., 3:]
    colour = over[..., :3] * alpha + under[..., :3] * (1.0 - alpha)
    made = bpy.data.images.new("laid over", *size)
    made.pixels.foreach_set(np.dstack([colour, np.ones_like(alpha)]).astype(np.float32).ravel())
    made.filepath_raw, made.file_format = str(picture), "PNG"
    made.save()
    bpy.data.images.remove(made)


def _read(path: Path, number: int, size: tuple[int, int] | None) -> tuple[np.ndarray, tuple[int, int]]:
    """Pixels as stored (h, w, 4), 0 to 1, lowest row first, scaled to `size` where one is given.

    Of a clip those of the frame with this number, counted from 1.
    """
    image = _load(path)
    # Also where the size stays: scaling is what makes Blender decode a certain frame of a clip.
    image.scale(*(size or image.size), frame=number)
    width, height = image.size
    pixels = np.empty(width * height * 4, dtype=np.float32)
    image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    return pixels.reshape(height, width, 4), (width, height)


def _load(path: Path) -> bpy.types.Image:
    try:
        return bpy.data.images.load(str(path.resolve()))
    except RuntimeError as error:
        raise ViewerError(f"cannot read the image {path}: {error}") from error


def _check_length(clip: bpy.types.Image, images: CameraImages) -> None:
    if clip.frame_duration != len(images.stamps_ns):
        raise ViewerError(
            f"{images.stored} has {clip.frame_duration} frames, "
            f"and {len(images.stamps_ns)} stamps in frames.jsonl"
        )
