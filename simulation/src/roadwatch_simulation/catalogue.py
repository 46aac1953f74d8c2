"""Every kind of thing that moves on the road, by name."""

from __future__ import annotations

from functools import lru_cache

from roadwatch_simulation.errors import SimulationError
from roadwatch_simulation.model import Model
from roadwatch_simulation.vehicles.bus import build_bus
from roadwatch_simulation.vehicles.car import build_car
from roadwatch_simulation.vehicles.lorry import build_lorry
from roadwatch_simulation.vehicles.shapes import SHAPES

KINDS: tuple[str, ...] = (
    "sedan", "compact", "suv", "pickup", "minivan", "wagon", "sports", "van", "bus", "truck",
    "pedestrian", "bicycle", "motorcycle",
)  # fmt: skip


@lru_cache(maxsize=512)
def build(
    kind: str,
    seed: int,
    *,
    size_lwh_m: tuple[float, float, float] | None = None,
    colour: tuple[float, float, float] | None = None,
) -> Model:
    """One model of `kind`, the same for the same arguments."""
    if kind in SHAPES:
        return build_car(kind, seed, size_lwh_m, colour)
    if kind == "bus":
        return build_bus(seed, size_lwh_m, colour)
    if kind == "truck":
        return build_lorry(seed, size_lwh_m, colour)
    if kind in KINDS:
        return build_car("van", seed, size_lwh_m or (8.0, 2.4, 3.0), colour)
    raise SimulationError(f"no model of kind {kind!r}: use one of {', '.join(KINDS)}")
