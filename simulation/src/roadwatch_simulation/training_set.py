"""Writes training pictures for a detector: `images/000000.jpg` and a line of `labels.jsonl` for each."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

from .capture import Capture, Studio
from .dataset import plain, refuse_existing
from .errors import SimulationError
from .progress import Report
from .scenarios.training import training_scene
from .scene import Scene

LABELS = "labels.jsonl"
SETTINGS = "training.json"


@dataclass(frozen=True)
class TrainingRange:
    """Which pictures of the endless training set with this seed."""

    seed: int
    first: int
    count: int


def write_training_set(
    wanted: TrainingRange, folder: Path, *, renderer: str = "light", progress: Report | None = None
) -> None:
    """Renders the pictures into a new folder; an interrupted run is taken up where it stopped.

    Pictures keep their number whatever the range, so that ranges rendered apart fit together. Raises
    SimulationError when the folder exists, or when an unfinished one beside it was made with other settings.
    """
    folder = Path(folder)
    if wanted.count < 1 or wanted.first < 0:
        raise SimulationError("a training set needs --count of 1 or more and --first of 0 or more")
    refuse_existing(folder)
    work = folder.with_name(f"{folder.name}.unfinished")
    done = _take_up(work, wanted)
    studio = Studio(renderer)
    with (work / LABELS).open("a") as labels:
        for step in range(done, wanted.count):
            index = wanted.first + step
            scene = training_scene(wanted.seed, index)
            capture = studio.capture(scene, 0, 0)
            name = f"images/{index:06d}.jpg"
            (work / name).write_bytes(capture.jpeg)
            labels.write(label_line(name, scene, capture))
            labels.flush()
            if progress:
                progress(step + 1, wanted.count)
    work.rename(folder)


def label_line(name: str, scene: Scene, capture: Capture) -> str:
    """One picture's line: its camera, its surroundings, and its objects as in truth.jsonl."""
    camera = scene.cameras[0]
    line = {
        "image": name, "width": camera.width_px, "height": camera.height_px, "fx": camera.fx, "fy": camera.fy,
        "cx": camera.cx, "cy": camera.cy, "position_m": camera.position_m,
        "orientation_wxyz": camera.orientation_wxyz, "environment": scene.environment.kind,
        "light": scene.environment.light, "objects": capture.objects,
    }  # fmt: skip
    return json.dumps(plain(line)) + "\n"


def _take_up(work: Path, wanted: TrainingRange) -> int:
    """Prepares the working folder; gives how many pictures are in it already."""
    settings = json.dumps({"seed": wanted.seed, "first": wanted.first, "count": wanted.count}) + "\n"
    (work / "images").mkdir(parents=True, exist_ok=True)
    noted = work / SETTINGS
    if not noted.exists():
        noted.write_text(settings)
    elif noted.read_text() != settings:
        raise SimulationError(
            f"`{work}` holds an unfinished run with other settings; finish that, or remove it")
    labels = work / LABELS
    if not labels.exists():
        return 0
    lines = [line for line in labels.read_text().splitlines(keepends=True) if line.endswith("\n")]
    labels.write_text("".join(lines))
    return len(lines)
