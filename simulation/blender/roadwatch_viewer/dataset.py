"""The images of a rig dataset, by camera and stamp (docs/evaluation.md)."""

from __future__ import annotations

import json
from bisect import bisect_left
from dataclasses import dataclass
from decimal import Decimal, InvalidOperation
from pathlib import Path

from .errors import ViewerError

CLIP_SUFFIX = ".mp4"


@dataclass(frozen=True)
class CameraImages:
    """One camera's images with their stamps, rising: a folder of pictures, or a clip of one frame per stamp.

    The number of an image is its file's, or its place in the clip counted from 1: as Blender counts both.
    """

    stored: Path
    stamps_ns: tuple[int, ...]
    numbers: tuple[int, ...]

    @property
    def is_clip(self) -> bool:
        """Whether all images are in one file."""
        return self.stored.suffix == CLIP_SUFFIX

    def nearest(self, stamp_ns: int) -> int:
        """The number of the image nearest in time; of two as near, the earlier one."""
        return self.numbers[self._nearest_place(stamp_ns)]

    def nearest_stamp_ns(self, stamp_ns: int) -> int:
        """When that image was captured."""
        return self.stamps_ns[self._nearest_place(stamp_ns)]

    def file(self, number: int) -> Path:
        """The file that has an image."""
        return self.stored if self.is_clip else self.stored / f"{number:04d}.jpg"

    def _nearest_place(self, stamp_ns: int) -> int:
        after = bisect_left(self.stamps_ns, stamp_ns)
        near = [place for place in (after - 1, after) if 0 <= place < len(self.stamps_ns)]
        return min(near, key=lambda place: abs(self.stamps_ns[place] - stamp_ns))


def read_images(dataset: Path) -> dict[str, CameraImages]:
    """The cameras that have images. Raises ViewerError for a folder that is no rig dataset with images."""
    frames = dataset / "frames.jsonl"
    stamps: dict[str, list[tuple[int, int]]] = {}
    try:
        with frames.open(encoding="utf-8") as lines:
            for number, line in enumerate(lines, 1):
                for camera, found in _stamps(line, f"{frames}:{number}"):
                    stamps.setdefault(camera, []).append(found)
    except OSError as error:
        raise ViewerError(
            f"{dataset} is no rig dataset: cannot read {frames.name} ({error.strerror})"
        ) from error
    cameras = {name: _images(dataset, name, sorted(found)) for name, found in stamps.items()}
    with_images = {
        name: images for name, images in cameras.items() if images.file(images.numbers[0]).is_file()
    }
    if not with_images:
        raise ViewerError(f"{dataset}: neither <camera>{CLIP_SUFFIX} nor <camera>/0000.jpg in it")
    return with_images


def _images(dataset: Path, camera: str, found: list[tuple[int, int]]) -> CameraImages:
    """Of stamps (ns) with frame numbers. Where there are both, the clip counts, as for the daemon."""
    stamps_ns, frames = zip(*found, strict=True)
    clip = dataset / f"{camera}{CLIP_SUFFIX}"
    if clip.is_file():
        return CameraImages(clip, stamps_ns, tuple(range(1, len(found) + 1)))
    return CameraImages(dataset / camera, stamps_ns, frames)


def _stamps(line: str, place: str) -> list[tuple[str, tuple[int, int]]]:
    """Cameras with stamp (ns) and frame number. Stamps are decimal seconds, of which all digits count."""
    try:
        frame = json.loads(line, parse_float=Decimal)
        number = int(frame["frame"])
        return [(camera, (int(Decimal(stamp) * 10**9), number)) for camera, stamp in frame["stamp"].items()]
    except (ValueError, KeyError, TypeError, AttributeError, InvalidOperation) as error:
        raise ViewerError(f'{place}: no line with "frame" and "stamp" ({error})') from error
