"""Places to look at: streets, junctions, car parks and an open plain, each different with its seed."""

from __future__ import annotations

from functools import lru_cache

from ..errors import SimulationError
from .car_park import build_car_park
from .junction import build_junction
from .layout import Bay, Footprint, Lane, Layout, Place
from .plain import build_plain
from .street import build_street

_BUILDERS = {
    "street": build_street, "junction": build_junction, "car_park": build_car_park, "plain": build_plain,
}  # fmt: skip
ENVIRONMENT_KINDS = tuple(_BUILDERS)

__all__ = ["ENVIRONMENT_KINDS", "Bay", "Footprint", "Lane", "Layout", "Place", "build_place"]


@lru_cache(maxsize=2)
def build_place(kind: str, seed: int) -> Place:
    """The place of that kind with that seed. The last two are kept: frames of a scene share theirs."""
    if kind not in _BUILDERS:
        raise SimulationError(f"environment `{kind}` does not exist; there are {', '.join(_BUILDERS)}")
    return _BUILDERS[kind](seed)
