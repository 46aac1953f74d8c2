"""Passenger cars, pickups and delivery vans: one way of building, many body styles."""

from __future__ import annotations

import numpy as np

from roadwatch_simulation.assembly import Assembly, Size
from roadwatch_simulation.materials import (
    GLASS,
    PILLAR,
    PLASTIC,
    PRIVACY_GLASS,
    UNDERBODY,
    WORK_PAINTS,
    Colour,
    car_colour,
    paint,
    pick,
)
from roadwatch_simulation.model import Model
from roadwatch_simulation.vehicles.cabin import add_cabin
from roadwatch_simulation.vehicles.fittings import add_fittings
from roadwatch_simulation.vehicles.front import add_front
from roadwatch_simulation.vehicles.look import Look, draw_look
from roadwatch_simulation.vehicles.plates import draw_plates
from roadwatch_simulation.vehicles.rear import add_rear
from roadwatch_simulation.vehicles.shapes import SHAPES, BodyShape
from roadwatch_simulation.vehicles.shell import Frame, Shell, build_shell, draw_frame
from roadwatch_simulation.vehicles.wheels import add_wheel, draw_wheels

TYRE_WIDTH_M = 0.215
WIDE_TYRE_M = 0.255


def build_car(kind: str, seed: int, size: Size | None, colour: Colour | None) -> Model:
    """A four-wheeled vehicle of one of `SHAPES`; what is None follows from the seed."""
    shape = SHAPES[kind]
    rng = np.random.default_rng([seed, sorted(SHAPES).index(kind)])
    drawn = _size(shape, rng)
    fleet = pick(WORK_PAINTS, rng) if kind == "van" else car_colour(rng)
    size = drawn if size is None else size
    frame = draw_frame(shape, size, rng)
    look = draw_look(shape, colour or fleet, rng)
    assembly = Assembly()
    shell = build_shell(frame)
    _add_shell(assembly, shell, look)
    _add_wheels(assembly, frame, rng)
    plates = draw_plates(rng)
    add_front(assembly, frame, shell, look, plates)
    add_rear(assembly, frame, shell, look, plates)
    add_fittings(assembly, frame, shell, look)
    add_cabin(assembly, frame, shell, look)
    return assembly.finish(kind, shape.object_class, size)


def _size(shape: BodyShape, rng: np.random.Generator) -> Size:
    """Length, width and height (m), larger cars being larger in every direction."""
    bulk = float(rng.random())
    length, width, height = (
        low + (high - low) * (0.6 * bulk + 0.4 * float(rng.random()))
        for low, high in (shape.length_m, shape.width_m, shape.height_m)
    )
    return (round(length, 3), round(width, 3), round(height, 3))


def _add_shell(assembly: Assembly, shell: Shell, look: Look) -> None:
    materials = {
        "paint": paint(look.colour),
        "glass": GLASS,
        "rear glass": PRIVACY_GLASS if look.privacy_glass else GLASS,
        "trim": PILLAR,
        "plastic": PLASTIC,
        "underbody": UNDERBODY,
    }
    for kind, material in materials.items():
        assembly.add(shell.patch.chosen(shell.kinds == kind), material)


def _add_wheels(assembly: Assembly, frame: Frame, rng: np.random.Generator) -> None:
    design = draw_wheels(rng, plain=0.5 if frame.shape is SHAPES["van"] else 0.18)
    width = WIDE_TYRE_M if frame.shape.rugged else TYRE_WIDTH_M
    for name, u, x in zip(("front", "rear"), frame.shape.wheels, frame.axles, strict=True):
        for side, sign in (("left", 1.0), ("right", -1.0)):
            y = sign * frame.half_width(u) * 0.985
            add_wheel(assembly, design, (x, y, frame.wheel_radius), width, f"tyre_{name}_{side}")
