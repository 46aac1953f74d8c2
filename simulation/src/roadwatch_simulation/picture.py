"""Writes one picture of a scene."""

from __future__ import annotations

from pathlib import Path

import cv2

from .capture import Studio
from .dataset import refuse_existing
from .errors import SimulationError
from .scene import Scene

SUFFIXES = (".png", ".jpg", ".jpeg")


def write_picture(scene: Scene, frame: int, camera: str | None, file: Path, renderer: str = "light") -> None:
    """Renders what a camera (by name; the first if None) delivers at a frame into a new PNG or JPEG file."""
    file = Path(file)
    if file.suffix.lower() not in SUFFIXES:
        raise SimulationError(f"`{file}` has to end in .png or .jpg")
    refuse_existing(file)
    if not 0 <= frame < scene.frames:
        raise SimulationError(f"there is no frame {frame}; the scene has frames 0 to {scene.frames - 1}")
    names = [mount.name for mount in scene.cameras]
    if camera is not None and camera not in names:
        raise SimulationError(f"there is no camera `{camera}`; the rig has {', '.join(names)}")
    capture = Studio(renderer).capture(scene, frame, names.index(camera) if camera else 0)
    if not file.parent.is_dir():
        raise SimulationError(f"the folder `{file.parent}` does not exist; make it first")
    if file.suffix.lower() == ".png":
        file.write_bytes(cv2.imencode(".png", capture.image_bgr)[1].tobytes())
    else:
        file.write_bytes(capture.jpeg)
