"""The trim of one car: what the seed decides beyond its shape and size."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from roadwatch_simulation.materials import Colour
from roadwatch_simulation.vehicles.shapes import BodyShape


@dataclass(frozen=True)
class Look:
    """Choices of trim; styles are small numbers, shares are 0 to 1, angles in degrees."""

    colour: Colour
    privacy_glass: bool
    grille_style: int
    grille_width: float
    grille_height: float
    lamp_style: int
    lamp_height: float
    tail_style: int
    tail_bar: bool
    plate_on_bumper: bool
    chrome: bool
    dark_roof: bool
    roof_rails: bool
    spoiler: bool
    antenna: int
    exhausts: int
    door_moulding: bool
    painted_handles: bool
    driver: bool
    passengers: int
    wheel_on_left: bool
    seen_through: bool


def draw_look(shape: BodyShape, colour: Colour, rng: np.random.Generator) -> Look:
    """Draws the trim of one car."""
    chance = rng.random(12)
    return Look(
        colour=colour,
        privacy_glass=bool(chance[0] < (0.55 if shape.hatch else 0.15)),
        grille_style=int(rng.integers(5)),
        grille_width=float(rng.uniform(0.36, 0.56)),
        grille_height=float(rng.uniform(0.7, 1.25)),
        lamp_style=int(rng.integers(4)),
        lamp_height=float(rng.uniform(0.75, 1.2)),
        tail_style=int(rng.integers(4)),
        tail_bar=bool(chance[1] < 0.22),
        plate_on_bumper=bool(chance[2] < 0.35),
        chrome=bool(chance[3] < 0.5),
        dark_roof=bool(chance[4] < 0.1),
        roof_rails=bool(chance[5] < (0.6 if shape.rugged or shape.hatch else 0.0)),
        spoiler=bool(chance[6] < (0.6 if shape.hatch or shape.doors == 1 else 0.15)),
        antenna=int(rng.integers(3)),
        exhausts=int(rng.choice([0, 1, 2], p=[0.35, 0.4, 0.25])),
        door_moulding=bool(chance[7] < 0.3),
        painted_handles=bool(chance[8] < 0.7),
        driver=bool(chance[9] < 0.5),
        passengers=int(rng.integers(0, 3)),
        wheel_on_left=bool(chance[10] < 0.85),
        seen_through=bool(chance[11] < 0.35),
    )
