"""What the detector tells apart."""

from __future__ import annotations

# COCO's names, in COCO's order, of what drives and walks on a road.
CLASS_NAMES = ("person", "bicycle", "car", "motorcycle", "bus", "truck")

# Pooled when vehicles are scored: detectors and labels draw the lines between these differently.
VEHICLE_CLASSES = frozenset({"car", "bus", "truck"})


def class_number(name: str) -> int | None:
    """The number of a class, None for one that the detector does not know."""
    return CLASS_NAMES.index(name) if name in CLASS_NAMES else None


def names_metadata() -> str:
    """The class names as YOLO exporters write them into a model's `names` entry, a Python dictionary."""
    return str(dict(enumerate(CLASS_NAMES)))
