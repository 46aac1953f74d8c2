"""H.264 clips of a rig dataset: `<camera>.mp4` instead of a folder of images."""

from __future__ import annotations

import shutil
from fractions import Fraction
from pathlib import Path

import av
import cv2
import numpy as np

from .dataset import Detail, new_folder, write_dataset
from .errors import SimulationError
from .progress import Report
from .scene import Scene

DEFAULT_CRF = 23
RATE_LIMIT = 1000
"""Largest denominator of a frame rate."""
UNCOMPRESSED_QUALITY = 98
"""JPEG quality of the pictures that a clip is made from: its own losses are then the codec's alone."""


def write_clips_dataset(
    scene: Scene, folder: Path, *, renderer: str = "light", crf: int = DEFAULT_CRF,
    progress: Report | None = None,
) -> None:
    """Renders a scene into a new folder with rig.toml, frames.jsonl, truth.jsonl and one clip per camera.

    Clips are for keeping, so truth.jsonl is lean.
    """
    with new_folder(Path(folder)) as work:
        images = work / "images"
        write_dataset(
            scene, images, renderer=renderer, jpeg_quality=UNCOMPRESSED_QUALITY, progress=progress,
            detail=Detail.LEAN,
        )  # fmt: skip
        for mount in scene.cameras:
            encode_clip(images / mount.name, work / f"{mount.name}.mp4", scene.rate_hz, crf)
        for name in ("rig.toml", "frames.jsonl", "truth.jsonl"):
            (images / name).rename(work / name)
        shutil.rmtree(images)


def encode_clip(images: Path, clip: Path, rate_hz: float, crf: int = DEFAULT_CRF) -> None:
    """Encodes a folder of numbered JPEG files, in their order, as H.264 with a constant frame rate.

    One thread and no date in the file: the same images give the same bytes. Raises SimulationError when
    there are no images, their sizes are odd or differ, or the CRF is not 0 to 51.
    """
    files = sorted(images.glob("*.jpg"))
    if not files:
        raise SimulationError(f"`{images}` holds no .jpg files to make a clip of")
    if not 0 <= crf <= 51:
        raise SimulationError(f"a clip's CRF is 0 to 51, not {crf}")
    first = _read(files[0])
    height, width = first.shape[:2]
    if width % 2 or height % 2:
        raise SimulationError(f"`{images}`: H.264 clips need an even width and height, not {width}x{height}")
    with av.open(str(clip), "w", format="mp4", container_options={"fflags": "+bitexact"}) as container:
        rate = Fraction(rate_hz).limit_denominator(RATE_LIMIT)
        stream = container.add_stream("libx264", rate=rate)
        stream.width, stream.height, stream.pix_fmt = width, height, "yuv420p"
        stream.codec_context.thread_count = 1
        stream.options = {"crf": str(crf), "preset": "medium", "flags": "+bitexact", "threads": "1"}
        for index, file in enumerate(files):
            image = _read(file)
            if image.shape != first.shape:
                raise SimulationError(f"`{file}` has another size than the first image of its folder")
            picture = av.VideoFrame.from_ndarray(image, format="bgr24")
            picture.pts, picture.time_base = index, 1 / rate
            container.mux(stream.encode(picture))
        container.mux(stream.encode(None))


def _read(file: Path) -> np.ndarray:
    image = cv2.imread(str(file), cv2.IMREAD_COLOR)
    if image is None:
        raise SimulationError(f"`{file}` is not a readable image")
    return image
