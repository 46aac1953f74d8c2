"""Scenes made by name and seed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from ..errors import SimulationError
from ..scene import Scene
from . import paper, study, tracking
from .drive import traffic
from .stage import FRAMES
from .training import training_scene


@dataclass(frozen=True)
class Scenario:
    """A generator of scenes: `build(seed, frames)`."""

    about: str
    frames: int
    build: Callable[[int, int], Scene]


def _one_picture(seed: int, frames: int) -> Scene:
    """The first picture of a training set, standing still for as long as asked."""
    return replace(training_scene(seed, 0), frames=frames)


SCENARIOS: dict[str, Scenario] = {
    "paper_x_path": Scenario("one car crosses 30 m ahead of a full-HD camera", 75, paper.x_path),
    "paper_y_path": Scenario("one car drives away from a full-HD camera, 8 to 45 m", 75, paper.y_path),
    "turntable": Scenario("one car turns through 360 degrees, 12 m ahead", 180, paper.turntable),
    "grid": Scenario("one car stands in every cell of a grid once", len(paper.grid_cells()), paper.grid),
    "long_path": Scenario("one car drives away from a full-HD camera, 6 to 60 m", 55, study.long_path),
    "vehicles": Scenario("every kind of vehicle, anywhere, at any heading", 60, study.vehicles),
    "car_row": Scenario("three cars side by side, 15, 30 and 45 m ahead in turns", 30, study.car_row),
    "traffic": Scenario("six cameras on a car in moving traffic", 120, traffic),
    "training": Scenario("one random picture for training a detector", 1, _one_picture),
    "tracking_crossing": Scenario("cars cross before six standing cameras", FRAMES, tracking.crossing),
    "tracking_overtaking": Scenario("a car overtakes six cameras, they another", FRAMES, tracking.overtaking),
    "tracking_occlusion": Scenario("a bus hides a parked and a moving car", FRAMES, tracking.occlusion),
    "tracking_parked_row": Scenario("six cameras drive between parked cars", FRAMES, tracking.parked_row),
    "tracking_u_turn": Scenario("a car ahead turns round and comes back", FRAMES, tracking.u_turn),
    "tracking_handover": Scenario(
        "a car circles six standing cameras", tracking.HANDOVER_FRAMES, tracking.handover
    ),
    "tracking_turning": Scenario("six cameras turn left at a junction", FRAMES, tracking.turning),
    "tracking_people": Scenario("people walk past each other before six cameras", FRAMES, tracking.people),
}


def build_scenario(name: str, seed: int = 0, frames: int | None = None) -> Scene:
    """The scene of that name with that seed, of its own length unless `frames` says otherwise."""
    if name not in SCENARIOS:
        raise SimulationError(f"scenario `{name}` does not exist; there are {', '.join(SCENARIOS)}")
    if frames is not None and frames < 1:
        raise SimulationError(f"a scenario needs at least 1 frame, not {frames}")
    scenario = SCENARIOS[name]
    return scenario.build(seed, scenario.frames if frames is None else frames)
