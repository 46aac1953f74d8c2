"""How many vehicles the detector finds, and how much of what it finds is one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from .boxes import pairwise_iou_array
from .classes import CLASS_NAMES, VEHICLE_CLASSES
from .inference import DEFAULT_SCORE_THRESHOLD, Detection, Detector
from .images import read_rgb
from .labels import Box, LabelledImage, ObjectLabel

MIN_IOU = 0.5
# Thresholds of the table beside the one asked for.
TABLE_THRESHOLDS = (0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6)


@dataclass(frozen=True)
class Scored:
    """Which objects count: as high as this, hidden and cut at most as much; classes are interchangeable."""

    classes: frozenset[str] = VEHICLE_CLASSES
    min_height_px: float = 24.0
    max_occluded: float = 0.05
    max_truncated: float = 0.05

    def admits(self, label: ObjectLabel) -> bool:
        return (
            self.may_stand(CLASS_NAMES[label.class_number])
            and label.height_px >= self.min_height_px
            and label.occluded <= self.max_occluded
            and label.truncated <= self.max_truncated
        )

    def may_stand(self, class_name: str) -> bool:
        return class_name in self.classes


@dataclass
class Tally:
    """Objects that count, scores of the detections that found one, and of those that are nothing."""

    objects: int = 0
    found: list[float] = field(default_factory=list)
    false_alarms: list[float] = field(default_factory=list)

    def recall(self, threshold: float) -> float:
        return sum(s >= threshold for s in self.found) / max(self.objects, 1)

    def precision(self, threshold: float) -> float:
        right = sum(s >= threshold for s in self.found)
        wrong = sum(s >= threshold for s in self.false_alarms)
        return right / max(right + wrong, 1)


def score(
    detector: Detector, images: list[LabelledImage], scored: Scored, progress: Callable[[int, int], None]
) -> Tally:
    """Detects in every image and matches; detections from the lowest threshold of the table up."""
    tally = Tally()
    for number, image in enumerate(images, start=1):
        detections = detector.detect(read_rgb(image.path), TABLE_THRESHOLDS[0])
        add_image(tally, detections, image.objects, scored)
        progress(number, len(images))
    return tally


def add_image(
    tally: Tally, detections: list[Detection], labels: tuple[ObjectLabel, ...], scored: Scored
) -> None:
    """Matches as `roadwatch evaluate` does: best score first, each takes the object it overlaps most.

    Only a detection that finds none that counts may stand for one that does not, by its whole box or by what
    is seen of it; it is then neither right nor wrong.
    """
    candidates = [label for label in labels if scored.may_stand(CLASS_NAMES[label.class_number])]
    counting = [label for label in candidates if scored.admits(label)]
    others = [label for label in candidates if not scored.admits(label)]
    tally.objects += len(counting)
    for detection in sorted(detections, key=lambda d: -d.score):
        if not scored.may_stand(detection.class_name):
            continue
        if _take_best(counting, detection, lambda label: [label.box_px]):
            tally.found.append(detection.score)
        elif not _take_best(others, detection, lambda label: [label.box_px, label.visible_px]):
            tally.false_alarms.append(detection.score)


def _take_best(
    free: list[ObjectLabel], detection: Detection, boxes: Callable[[ObjectLabel], list[Box]]
) -> bool:
    """Takes away the object that one of whose boxes overlaps most; false where that is too little."""
    if not free:
        return False
    of_each = np.array([boxes(label) for label in free], np.float32)
    overlaps = pairwise_iou_array(detection.box_px[None].astype(np.float32), of_each.reshape(-1, 4))
    overlaps = overlaps.reshape(of_each.shape[:2]).max(1)
    best = int(overlaps.argmax())
    if overlaps[best] < MIN_IOU:
        return False
    del free[best]
    return True


def table(tally: Tally, threshold: float = DEFAULT_SCORE_THRESHOLD) -> str:
    """Recall and precision at many thresholds, the one asked for marked, as Markdown."""
    lines = [f"{tally.objects} objects count", "", "| score | recall | precision |", "|---|---|---|"]
    for at in sorted({*TABLE_THRESHOLDS, threshold}):
        mark = " (asked for)" if at == threshold else ""
        lines.append(f"| {at:.2f}{mark} | {tally.recall(at):.3f} | {tally.precision(at):.3f} |")
    return "\n".join(lines)
