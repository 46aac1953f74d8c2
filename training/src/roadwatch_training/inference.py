"""The exported detector, run the way the daemon runs it."""

from __future__ import annotations

import ast
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
import onnxruntime

from .boxes import pairwise_iou_array
from .errors import TrainingError
from .augment.geometry import PADDING_GREY

DEFAULT_SCORE_THRESHOLD = 0.25
# The demo's own configuration: of boxes of one class that overlap more, the best stays, and so it does among
# classes that one object is not two of.
MAX_OVERLAP = 0.45
ONE_OF = ("car", "bus", "truck")

# Left and top, pixels.
Offset = tuple[int, int]


@dataclass(frozen=True)
class Detection:
    """A box (left, top, right, bottom) in pixels of the image, the class's name, the score."""

    class_name: str
    score: float
    box_px: np.ndarray


class Detector:
    """An ONNX file with a YOLOv8-shaped output."""

    def __init__(self, path: Path, threads: int = 2) -> None:
        if not path.is_file():
            raise TrainingError(f"`{path}` does not exist: train or export a model first")
        options = onnxruntime.SessionOptions()
        options.intra_op_num_threads = threads
        self.session = onnxruntime.InferenceSession(str(path), options, providers=["CPUExecutionProvider"])
        described = self.session.get_inputs()[0]
        self.input_name = described.name
        self.height_px, self.width_px = described.shape[2:]
        names = self.session.get_modelmeta().custom_metadata_map.get("names")
        if names is None:
            raise TrainingError(f"`{path}` has no class names in its metadata: export it with this program")
        self.class_names = tuple(ast.literal_eval(names).values())

    def detect(self, image: np.ndarray, score_threshold: float = DEFAULT_SCORE_THRESHOLD) -> list[Detection]:
        """Detections in an RGB uint8 image, best score first, overlapping ones of a class suppressed."""
        canvas, gain, offset = letterboxed(image, self.width_px, self.height_px)
        tensor = canvas.transpose(2, 0, 1)[None].astype(np.float32) / 255
        output = self.session.run(None, {self.input_name: tensor})[0][0]
        classes, scores = output[4:].argmax(0), output[4:].max(0)
        kept = np.flatnonzero(scores >= score_threshold)
        kept = kept[np.argsort(-scores[kept], kind="stable")]
        boxes = _image_boxes(output[:4, kept].T, gain, offset, image.shape)
        names = [self.class_names[number] for number in classes[kept]]
        chosen = suppressed(boxes, [ONE_OF[0] if name in ONE_OF else name for name in names])
        return [Detection(names[at], float(scores[kept[at]]), boxes[at]) for at in chosen]


def letterboxed(image: np.ndarray, width_px: int, height_px: int) -> tuple[np.ndarray, float, Offset]:
    """The image resized with its aspect kept and centred on grey; pixels per image pixel; place."""
    gain = min(width_px / image.shape[1], height_px / image.shape[0])
    width, height = round(image.shape[1] * gain), round(image.shape[0] * gain)
    left, top = (width_px - width) // 2, (height_px - height) // 2
    canvas = np.full((height_px, width_px, 3), PADDING_GREY, np.uint8)
    resized = cv2.resize(image, (width, height), interpolation=cv2.INTER_LINEAR)
    canvas[top : top + height, left : left + width] = resized
    return canvas, gain, (left, top)


def _image_boxes(rows: np.ndarray, gain: float, offset: Offset, shape: tuple[int, ...]) -> np.ndarray:
    """From centre and size in the input to edges in the image, clipped to it."""
    corners = np.concatenate((rows[:, :2] - rows[:, 2:] / 2, rows[:, :2] + rows[:, 2:] / 2), axis=1)
    boxes = (corners - np.array([*offset, *offset], np.float32)) / np.float32(gain)
    return boxes.clip(0, np.array([shape[1], shape[0]] * 2, np.float32))


def suppressed(boxes: np.ndarray, kinds: list[str]) -> list[int]:
    """Of boxes sorted best first, those that overlap no better one of their kind."""
    overlaps = pairwise_iou_array(boxes, boxes) > MAX_OVERLAP
    kept: list[int] = []
    for at in range(len(boxes)):
        if not any(overlaps[at, better] and kinds[at] == kinds[better] for better in kept):
            kept.append(at)
    return kept
