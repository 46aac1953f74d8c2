"""The images of a rig dataset, by camera and stamp (docs/evaluation.md)."""

from __future__ import annotations

import json
from bisect import bisect_left
from dataclasses import dataclass
from decimal import Decimal, InvalidOperation
from pathlib import Path

from .errors import ViewerError


@dataclass(frozen=True)
class CameraImages:
    """One camera's images: their stamps, rising, and their frame numbers."""

    folder: Path
    stamps_ns: tuple[int, ...]
    frames: tuple[int, ...]

    def nearest(self, stamp_ns: int) -> int:
        """The frame number of the image nearest in time; of two as near, the earlier one."""
        after = bisect_left(self.stamps_ns, stamp_ns)
        near = [place for place in (after - 1, after) if 0 <= place < len(self.stamps_ns)]
        return self.frames[min(near, key=lambda place: abs(self.stamps_ns[place] - stamp_ns))]

    def path(self, frame: int) -> Path:
        """Where a frame's image lies."""
        return self.folder / f"{frame:04d}.jpg"


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
    cameras = {
        name: CameraImages(dataset / name, *map(tuple, zip(*sorted(found), strict=True)))
        for name, found in stamps.items()
    }
    with_images = {
        name: images for name, images in cameras.items() if images.path(images.frames[0]).is_file()
    }
    if not with_images:
        raise ViewerError(
            f"{dataset}: no <camera>/0000.jpg in it; a dataset of clips has to be unpacked first"
        )
    return with_images


def _stamps(line: str, place: str) -> list[tuple[str, tuple[int, int]]]:
    """Cameras with stamp (ns) and frame number. Stamps are decimal seconds, of which all digits count."""
    try:
        frame = json.loads(line, parse_float=Decimal)
        number = int(frame["frame"])
        return [(camera, (int(Decimal(stamp) * 10**9), number)) for camera, stamp in frame["stamp"].items()]
    except (ValueError, KeyError, TypeError, AttributeError, InvalidOperation) as error:
        raise ViewerError(f'{place}: no line with "frame" and "stamp" ({error})') from error
