"""What the head finds, and in what order it gives it."""

from __future__ import annotations

import numpy as np

# The simulator's names; a head's file lists them, and the forest that reads them refuses another list.
COMPONENTS = (
    "tyre_front_left",
    "tyre_front_right",
    "tyre_rear_left",
    "tyre_rear_right",
    "mirror_left",
    "mirror_right",
    "plate_front",
    "plate_rear",
    "headlamp_left",
    "headlamp_right",
    "taillamp_left",
    "taillamp_right",
)


def _mirror_of(name: str) -> str:
    if name.endswith("_left"):
        return name.removesuffix("_left") + "_right"
    return name.removesuffix("_right") + "_left" if name.endswith("_right") else name


# Component number n of a vehicle is number MIRRORED[n] of the same vehicle seen in a mirror.
MIRRORED = np.array([COMPONENTS.index(_mirror_of(name)) for name in COMPONENTS])
