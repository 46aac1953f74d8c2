"""Which of our models stands for an object of a class and size."""

from __future__ import annotations

BLOCK = "block"
PAWN = "pawn"
MODELS: tuple[str, ...] = (
    "sedan", "compact", "suv", "van", "pickup", "truck", "bus", "pedestrian", "bicycle", "motorcycle",
)  # fmt: skip

_FIXED: dict[str, str] = {
    "bus": "bus",
    "van": "van",
    "minivan": "van",
    "pickup": "pickup",
    "lorry": "truck",
    "person": "pedestrian",
    "pedestrian": "pedestrian",
    "bicycle": "bicycle",
    "cyclist": "bicycle",
    "motorcycle": "motorcycle",
    "motorbike": "motorcycle",
    "motorcyclist": "motorcycle",
}


def kind_of(class_id: str, size_lwh_m: tuple[float, float, float]) -> str:
    """A model's name; `BLOCK` for a class without one. Cars and trucks differ by size."""
    length_m, _, height_m = size_lwh_m
    if class_id == "car":
        if height_m > 1.95:
            return "van"
        if height_m > 1.58:
            return "suv"
        return "compact" if length_m < 4.2 else "sedan"
    if class_id == "truck":
        if height_m < 1.95:
            return "pickup"
        return "van" if height_m < 2.6 and length_m < 6.2 else "truck"
    return _FIXED.get(class_id, BLOCK)


def kind_without_heading(kind: str) -> str:
    """A shape that points nowhere."""
    return PAWN if kind == "pedestrian" else BLOCK
