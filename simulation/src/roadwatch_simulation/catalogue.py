"""Every kind of thing that moves on the road, by name."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

from roadwatch_simulation.assembly import Size
from roadwatch_simulation.errors import SimulationError
from roadwatch_simulation.materials import Colour
from roadwatch_simulation.model import Model
from roadwatch_simulation.people import build_cyclist, build_motorcyclist, build_pedestrian
from roadwatch_simulation.vehicles.bus import build_bus
from roadwatch_simulation.vehicles.car import build_car
from roadwatch_simulation.vehicles.lorry import build_lorry
from roadwatch_simulation.vehicles.shapes import SHAPES

KINDS: tuple[str, ...] = (
    "sedan", "compact", "suv", "pickup", "minivan", "wagon", "sports", "van", "bus", "truck",
    "pedestrian", "bicycle", "motorcycle",
)  # fmt: skip

_OTHERS: dict[str, Callable[[int, Size | None, Colour | None], Model]] = {
    "bus": build_bus,
    "truck": build_lorry,
    "pedestrian": build_pedestrian,
    "bicycle": build_cyclist,
    "motorcycle": build_motorcyclist,
}


@lru_cache(maxsize=512)
def build(
    kind: str,
    seed: int,
    *,
    size_lwh_m: Size | None = None,
    colour: Colour | None = None,
) -> Model:
    """One model of `kind`, the same for the same arguments."""
    if kind in SHAPES:
        return build_car(kind, seed, size_lwh_m, colour)
    if kind in _OTHERS:
        return _OTHERS[kind](seed, size_lwh_m, colour)
    raise SimulationError(f"no model of kind {kind!r}: use one of {', '.join(KINDS)}")
