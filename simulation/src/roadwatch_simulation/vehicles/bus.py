"""Buses: the loft of a car with a flat nose, many windows, doors and a destination board."""

from __future__ import annotations

import numpy as np

from roadwatch_simulation.assembly import Assembly, Size
from roadwatch_simulation.geometry import box, limb
from roadwatch_simulation.materials import (
    AMBER,
    BEHIND_GLASS_DARK,
    BEHIND_GLASS_PALE,
    GLASS,
    LAMP_CLEAR,
    LAMP_LIT,
    MIRROR_GLASS,
    PIANO_BLACK,
    PLASTIC,
    SEAM,
    SIGN_LETTERS,
    TAIL_RED,
    UNDERBODY,
    WORK_PAINTS,
    Colour,
    paint,
    pick,
)
from roadwatch_simulation.model import Model
from roadwatch_simulation.vehicles.drape import Drape
from roadwatch_simulation.vehicles.plates import add_plate, draw_plates
from roadwatch_simulation.vehicles.shapes import BUS_SHAPE
from roadwatch_simulation.vehicles.shell import Frame, Shell, build_shell, draw_frame
from roadwatch_simulation.vehicles.wheels import add_wheel, draw_wheels

TYRE_WIDTH_M = 0.30


def build_bus(seed: int, size: Size | None, colour: Colour | None) -> Model:
    """A city bus or coach; what is None follows from the seed."""
    rng = np.random.default_rng([seed, 101])
    ranges = (BUS_SHAPE.length_m, BUS_SHAPE.width_m, BUS_SHAPE.height_m)
    drawn = tuple(round(float(rng.uniform(*span)), 3) for span in ranges)
    fleet, band = pick(WORK_PAINTS, rng), pick(WORK_PAINTS, rng)
    size = (drawn[0], drawn[1], drawn[2]) if size is None else size
    frame = draw_frame(BUS_SHAPE, size, rng)
    shell = build_shell(frame)
    assembly = Assembly()
    coat = paint(colour or fleet)
    pillars = coat if rng.random() < 0.4 else PIANO_BLACK
    materials = {"paint": coat, "glass": GLASS, "rear glass": GLASS, "trim": pillars, "underbody": UNDERBODY}
    for kind, material in materials.items():
        assembly.add(shell.patch.chosen(shell.kinds == kind), material)
    _add_wheels(assembly, frame, rng)
    _add_front(assembly, frame, shell, rng)
    _add_rear(assembly, frame, shell)
    _add_sides(assembly, frame, shell, band, rng)
    _add_roof(assembly, frame, rng)
    plates = draw_plates(rng)
    add_plate(assembly, plates, (frame.x(0.0), 0.0, 0.55), "plate_front")
    add_plate(assembly, plates, (frame.x(1.0), 0.0, 0.75), "plate_rear")
    return assembly.finish("bus", BUS_SHAPE.object_class, size)


def _add_wheels(assembly: Assembly, frame: Frame, rng: np.random.Generator) -> None:
    design = draw_wheels(rng, plain=0.7)
    for name, x in zip(("front", "rear"), frame.axles, strict=True):
        for side, sign in (("left", 1.0), ("right", -1.0)):
            place = (x, sign * frame.size[1] * 0.492, frame.wheel_radius)
            add_wheel(assembly, design, place, TYRE_WIDTH_M, f"tyre_{name}_{side}")


def _add_front(assembly: Assembly, frame: Frame, shell: Shell, rng: np.random.Generator) -> None:
    ahead = Drape(shell.patch, 0.0)
    half, height = frame.size[1] / 2, frame.size[2]
    assembly.add(ahead.rectangle((-half * 0.72, half * 0.72), (height * 0.885, height * 0.955)), PIANO_BLACK)
    for slot in range(9):
        if slot == 3 or rng.random() < 0.15:
            continue
        left = -0.55 + slot * 0.125
        letter = ahead.rectangle((left, left + 0.085), (height * 0.905, height * 0.94))
        assembly.add(letter.moved((0.006, 0, 0)), SIGN_LETTERS)
    lamp = ahead.rectangle((half * 0.56, half * 0.86), (height * 0.235, height * 0.295))
    assembly.add_both_sides(lamp, LAMP_CLEAR, "headlamp")
    for across in (0.64, 0.78):
        lens = ahead.ellipse((half * across, height * 0.265), (0.075, 0.07), 0.012)
        assembly.add_both_sides(lens, LAMP_LIT, "headlamp")
    blinker = ahead.ellipse((half * 0.84, height * 0.25), (0.03, 0.05), 0.012)
    assembly.add_both_sides(blinker, AMBER, "headlamp")
    assembly.add(ahead.rectangle((-half * 0.45, half * 0.45), (height * 0.22, height * 0.29)), PLASTIC)
    assembly.add(ahead.rectangle((-half * 0.80, half * 0.80), (0.36, 0.44)), PLASTIC)
    seat = half * 0.45
    assembly.add(ahead.ellipse((seat, height * 0.60), (0.11, 0.15), 0.009), BEHIND_GLASS_PALE)
    assembly.add(ahead.ellipse((seat, height * 0.50), (0.28, 0.20), 0.007), BEHIND_GLASS_DARK)
    for line in ([(0.9, 0.47), (0.1, 0.50)], [(-0.05, 0.47), (-0.85, 0.50)]):
        wiper = [(half * across, height * up) for across, up in line]
        assembly.add(ahead.stroke(wiper, 0.03, lift_m=0.012), PLASTIC)
    _add_mirrors(assembly, frame)


def _add_mirrors(assembly: Assembly, frame: Frame) -> None:
    half, height = frame.size[1] / 2, frame.size[2]
    place = (frame.x(0.0) - 0.02, half + 0.19, height * 0.66)
    assembly.add_both_sides(box(place, (0.14, 0.24, 0.46), 0.3), PLASTIC, "mirror")
    glass = box((place[0] - 0.073, place[1], place[2]), (0.01, 0.19, 0.39))
    assembly.add_both_sides(glass, MIRROR_GLASS, "mirror")
    arm = limb((frame.x(0.02), half * 0.9, height * 0.86), (*place[:2], place[2] + 0.2), 0.03, 0.03, 6)
    assembly.add_both_sides(arm, PLASTIC, "mirror")


def _add_rear(assembly: Assembly, frame: Frame, shell: Shell) -> None:
    behind = Drape(shell.patch, 180.0)
    half, height = frame.size[1] / 2, frame.size[2]
    assembly.add(behind.rectangle((-half * 0.72, half * 0.72), (height * 0.52, height * 0.82), 0.12), GLASS)
    assembly.add(behind.rectangle((-half * 0.62, half * 0.62), (height * 0.24, height * 0.42), 0.12), PLASTIC)
    assembly.add(behind.rectangle((-half * 0.80, half * 0.80), (0.36, 0.48), 0.12), PLASTIC)
    lamp = behind.rectangle((-half * 0.86, -half * 0.74), (height * 0.26, height * 0.43))
    assembly.add_both_sides(lamp, TAIL_RED, "taillamp")
    blinker = behind.ellipse((-half * 0.80, height * 0.39), (0.05, 0.05), 0.01)
    assembly.add_both_sides(blinker, AMBER, "taillamp")


def _add_sides(
    assembly: Assembly, frame: Frame, shell: Shell, band: Colour, rng: np.random.Generator
) -> None:
    left, right = Drape(shell.patch, 90.0), Drape(shell.patch, 270.0)
    height = frame.size[2]
    if rng.random() < 0.6:
        stripe = [(-frame.x(u), height * 0.305) for u in (0.03, 0.97)]
        assembly.add_both_sides(left.stroke(stripe, 0.16, 0.3, 0.003), paint(band))
    skirt = [(-frame.x(u), 0.52) for u in (0.28, 0.67)]
    assembly.add_both_sides(left.stroke(skirt, 0.012, 0.3), SEAM)
    for u in (0.35, 0.45, 0.55, 0.62):
        assembly.add_both_sides(left.stroke([(-frame.x(u), 0.34), (-frame.x(u), height * 0.34)], 0.010), SEAM)
    for window in frame.shape.side_windows[1:]:
        for share in (0.3, 0.75):
            x = frame.x(window[0] + (window[1] - window[0]) * share)
            seat = left.mound((-x, height * 0.39), 0.22, 0.11 * height, 0.006)
            assembly.add_both_sides(seat, BEHIND_GLASS_DARK)
            if rng.random() < 0.3:
                head = left.ellipse((-x - 0.1, height * 0.52), (0.09, 0.12), 0.009)
                assembly.add_both_sides(head, BEHIND_GLASS_PALE)
    for span in ((0.038, 0.085), (0.44, 0.545)) if rng.random() < 0.8 else ((0.038, 0.085),):
        _add_door(assembly, frame, right, span)


def _add_door(assembly: Assembly, frame: Frame, right: Drape, span: tuple[float, float]) -> None:
    """A glazed two-leaf door on the kerb side, between two places along the bus."""
    height = frame.size[2]
    near, far = sorted((frame.x(span[0]), frame.x(span[1])))
    assembly.add(right.rectangle((near, far), (0.36, height * 0.80), 0.15), PIANO_BLACK)
    middle = (near + far) / 2
    for low, high in ((near + 0.05, middle - 0.03), (middle + 0.03, far - 0.05)):
        pane = right.rectangle((low, high), (0.48, height * 0.78), 0.15)
        assembly.add(pane.moved((0.0, -0.006, 0.0)), GLASS)


def _add_roof(assembly: Assembly, frame: Frame, rng: np.random.Generator) -> None:
    if rng.random() < 0.6:
        length = frame.size[0] * float(rng.uniform(0.15, 0.3))
        x = frame.x(float(rng.uniform(0.35, 0.65)))
        unit = box((x, 0.0, frame.size[2] + 0.08), (length, frame.size[1] * 0.6, 0.2), 0.3)
        assembly.add(unit, paint((0.6, 0.6, 0.6)))
