"""Writes rig datasets: rig.toml, frames.jsonl, truth.jsonl and one folder of images per camera."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from enum import Enum
from pathlib import Path

import numpy as np

from .capture import Capture, Studio
from .errors import SimulationError
from .progress import Report
from .rig import quaternion_wxyz, rig_toml
from .scene import Scene

NANOSECONDS = 1_000_000_000


class Detail(Enum):
    """How much goes into truth.jsonl."""

    FULL = "full"
    LEAN = "lean"
    """Objects of which something is seen, without their parts: a tenth of the file."""


def write_dataset(
    scene: Scene, folder: Path, *, renderer: str = "light", jpeg_quality: int | None = None,
    progress: Report | None = None, detail: Detail = Detail.FULL,
) -> None:
    """Renders every frame of every camera into a new folder, which appears only when all of it is there.

    Raises SimulationError when the folder exists or the renderer does not. The same scene gives the same
    bytes on the same machine.
    """
    studio = Studio(renderer)
    with new_folder(Path(folder)) as work:
        (work / "rig.toml").write_text(rig_toml(scene.cameras))
        for mount in scene.cameras:
            (work / mount.name).mkdir()
        with (work / "frames.jsonl").open("w") as frames, (work / "truth.jsonl").open("w") as truth:
            for frame in range(scene.frames):
                frames.write(frame_line(scene, frame))
                for index, mount in enumerate(scene.cameras):
                    capture = studio.capture(scene, frame, index, jpeg_quality)
                    (work / mount.name / f"{frame:04d}.jpg").write_bytes(capture.jpeg)
                    truth.write(truth_line(frame, mount.name, capture, detail))
                    if progress:
                        progress(frame * len(scene.cameras) + index + 1, scene.frames * len(scene.cameras))


def frame_line(scene: Scene, frame: int) -> str:
    """A line of frames.jsonl. Stamps are seconds with all nine digits, which a float would not keep.

    The vehicle's pose is that at the frame's own moment, `ego_stamp`, whenever its cameras fire.
    """
    moments = {mount.name: stamp_text(scene.stamp_ns(frame, mount)) for mount in scene.cameras}
    stamps = ", ".join(f'"{name}": {stamp}' for name, stamp in moments.items())
    world_from_base, _ = scene.at(frame)
    position = json.dumps([round(float(value), 6) for value in world_from_base[:3, 3]])
    orientation = json.dumps(list(quaternion_wxyz(world_from_base[:3, :3])))
    return (
        f'{{"frame": {frame}, "stamp": {{{stamps}}}, "ego_stamp": {stamp_text(scene.stamp_ns(frame))}, '
        f'"ego_position_world_m": {position}, "ego_orientation_world_wxyz": {orientation}}}\n'
    )


def truth_line(frame: int, camera: str, capture: Capture, detail: Detail = Detail.FULL) -> str:
    """A line of truth.jsonl."""
    objects = capture.objects
    if detail is Detail.LEAN:
        objects = [_without_parts(thing) for thing in objects if thing["visible_px"]]
    return json.dumps({"frame": frame, "camera": camera, "objects": plain(objects)}) + "\n"


def _without_parts(thing: dict) -> dict:
    return {key: value for key, value in thing.items() if key != "parts"}


def stamp_text(stamp_ns: int) -> str:
    """Nanoseconds as exact decimal seconds."""
    return f"{stamp_ns // NANOSECONDS}.{stamp_ns % NANOSECONDS:09d}"


def plain(value):
    """The value with numpy's numbers and arrays as JSON's."""
    if isinstance(value, dict):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple | np.ndarray):
        return [plain(item) for item in value]
    return value.item() if isinstance(value, np.generic) else value


@contextmanager
def new_folder(folder: Path) -> Iterator[Path]:
    """A working folder beside `folder`, renamed to it at the end, or removed when anything fails."""
    refuse_existing(folder)
    work = folder.with_name(f".{folder.name}.unfinished")
    shutil.rmtree(work, ignore_errors=True)
    try:
        work.mkdir(parents=True)
    except OSError as error:
        raise SimulationError(f"cannot make the folder `{work}`: {error.strerror}") from error
    try:
        yield work
        work.rename(folder)
    except BaseException:
        shutil.rmtree(work, ignore_errors=True)
        raise


def refuse_existing(folder: Path) -> None:
    """Raises SimulationError when something has that name already."""
    if folder.exists():
        raise SimulationError(f"`{folder}` exists already; name another folder, or remove it first")
