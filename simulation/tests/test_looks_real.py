"""A network that never saw these pictures takes the simulated cars for cars."""

from __future__ import annotations

import os
import warnings
from pathlib import Path

import cv2
import numpy as np
import pytest

from roadwatch_simulation.capture import Studio
from roadwatch_simulation.errors import SimulationError
from roadwatch_simulation.scenarios import build_scenario

SHARED = Path(os.environ.get("ROADWATCH_SHARED", Path(__file__).parents[3] / "shared"))
MODEL = SHARED / "models" / "yolov5n_640.onnx"
INPUT_PX = 640
SCORE = 0.25
LEAST_IOU = 0.5
CAR_OR_TRUCK = (2, 7)
"""COCO's numbers; between them labels and detectors draw the line differently."""
NEAREST_M, FARTHEST_M = 8.0, 45.0
LEAST_RECALL = 0.9
VIEWS = {"light": [(seed, frame) for seed in (31, 32, 33, 34) for frame in (0, 30)], "blender": [(31, 0)]}
"""Seeds of the scenario `traffic` and frames; every camera that shows a car counts. Cycles is slow."""


@pytest.mark.parametrize("renderer", ["light", "blender"])
def test_a_network_trained_on_photographs_finds_the_cars(renderer):
    network = _network()
    studio = _studio(renderer)
    found = [hit for seed, frame in VIEWS[renderer] for hit in _hits(network, studio, seed, frame)]
    print(f"{renderer}: {sum(found)} of {len(found)} cars found")
    assert len(found) >= 8, "too few cars to say anything"
    assert sum(found) >= LEAST_RECALL * len(found)


def _network():
    runtime = pytest.importorskip("onnxruntime")
    if not MODEL.is_file():
        warnings.warn(f"SKIPPED: {MODEL} is absent; ROADWATCH_SHARED names its folder", stacklevel=1)
        pytest.skip(f"{MODEL} is absent")
    return runtime.InferenceSession(str(MODEL), providers=["CPUExecutionProvider"])


def _studio(renderer: str) -> Studio:
    if renderer == "blender":
        try:
            import roadwatch_simulation.blender  # noqa: F401
        except SimulationError as error:
            warnings.warn(f"SKIPPED: {error}", stacklevel=1)
            pytest.skip(str(error))
    return Studio(renderer)


def _hits(network, studio: Studio, seed: int, frame: int) -> list[bool]:
    """For every clear car in the six views of one moment, whether it is found."""
    scene = build_scenario("traffic", seed, frame + 1)
    hits: list[bool] = []
    for camera in range(len(scene.cameras)):
        capture = studio.capture(scene, frame, camera)
        cars = [thing for thing in capture.objects if _is_clear_car(thing)]
        if cars:
            boxes = _detect(network, cv2.imdecode(np.frombuffer(capture.jpeg, np.uint8), cv2.IMREAD_COLOR))
            hits += [max((_iou(box, car["silhouette_px"]) for box in boxes), default=0.0) >= LEAST_IOU for car in cars]
    return hits


def _is_clear_car(thing: dict) -> bool:
    distance_m = float(np.linalg.norm(thing["center_camera_m"]))
    clear = thing["occluded"] <= 0.05 and thing["truncated"] <= 0.0
    return thing["class"] == "car" and clear and NEAREST_M <= distance_m <= FARTHEST_M


def _detect(network, image: np.ndarray) -> np.ndarray:
    """Boxes of cars and trucks in the image's pixels, edges; overlapping ones are left in."""
    height, width = image.shape[:2]
    scale = INPUT_PX / max(height, width)
    small = cv2.resize(image, (round(width * scale), round(height * scale)), interpolation=cv2.INTER_LINEAR)
    top = (INPUT_PX - small.shape[0]) // 2
    padded = np.full((INPUT_PX, INPUT_PX, 3), 114, np.uint8)
    padded[top : top + small.shape[0], : small.shape[1]] = small
    tensor = np.ascontiguousarray(padded[None, :, :, ::-1].transpose(0, 3, 1, 2), np.float32) / 255.0
    (output,) = network.run(None, {network.get_inputs()[0].name: tensor})
    rows = output[0]
    scores = rows[:, 4] * rows[:, [5 + number for number in CAR_OR_TRUCK]].max(axis=1)
    x, y, w, h = rows[scores >= SCORE, :4].T
    return np.stack([x - w / 2, y - h / 2 - top, x + w / 2, y + h / 2 - top], axis=1) / scale


def _iou(a, b) -> float:
    width, height = min(a[2], b[2]) - max(a[0], b[0]), min(a[3], b[3]) - max(a[1], b[1])
    if width <= 0 or height <= 0:
        return 0.0
    both = width * height
    return both / ((a[2] - a[0]) * (a[3] - a[1]) + (b[2] - b[0]) * (b[3] - b[1]) - both)
