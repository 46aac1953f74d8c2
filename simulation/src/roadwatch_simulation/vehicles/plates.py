"""Number plates: European, American or square, each with made-up letters."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from roadwatch_simulation.assembly import Assembly
from roadwatch_simulation.geometry import Patch, box
from roadwatch_simulation.materials import PLATE_BAND, PLATE_INK, PLATE_WHITE, PLATE_YELLOW
from roadwatch_simulation.model import Material

THICKNESS_M = 0.012


@dataclass(frozen=True)
class PlateStyle:
    """Size (m) and colours of a vehicle's plates."""

    width: float
    height: float
    front: Material
    rear: Material
    band: bool
    letters: tuple[float, ...]


def draw_plates(rng: np.random.Generator) -> PlateStyle:
    """A plate style: European in two out of three cases."""
    european = bool(rng.random() < 0.65)
    width, height = (0.52, 0.115) if european else (0.305, 0.155)
    yellow = bool(rng.random() < 0.25)
    count = 7
    slots = [slot for slot in range(count) if slot != int(rng.integers(2, 5))]
    letters = tuple((slot - (count - 1) / 2) / count * 0.80 + (0.03 if european else 0.0) for slot in slots)
    return PlateStyle(
        width, height, PLATE_WHITE, PLATE_YELLOW if yellow else PLATE_WHITE, european, letters
    )


def add_plate(assembly: Assembly, style: PlateStyle, place: tuple[float, float, float], part: str) -> None:
    """Adds a plate with its back at `place` (m), facing forward if x is above 0, else backward."""
    faces_forward = place[0] > 0
    material = style.front if faces_forward else style.rear
    pieces: list[tuple[Patch, Material]] = [
        (box((THICKNESS_M / 2, 0, 0), (THICKNESS_M, style.width, style.height)), material)
    ]
    if style.band:
        pieces.append((_mark(style, -0.465, 0.06, 0.96), PLATE_BAND))
    pieces += [(_mark(style, slot, 0.072, 0.58), PLATE_INK) for slot in style.letters]
    for patch, ink in pieces:
        facing = patch if faces_forward else patch.turned(np.diag([-1.0, -1.0, 1.0]))
        assembly.add(facing.moved(place), ink, part)


def _mark(style: PlateStyle, across: float, width: float, height: float) -> Patch:
    """A thin block on the plate's face; sizes and place are shares of the plate."""
    size = (0.003, width * style.width, height * style.height)
    return box((THICKNESS_M + 0.0015, across * style.width, 0.0), size)
