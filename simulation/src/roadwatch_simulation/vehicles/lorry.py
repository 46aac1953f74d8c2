"""Box lorries: a forward cab, a ladder chassis and a cargo box."""

from __future__ import annotations

import numpy as np

from roadwatch_simulation.assembly import Assembly, Size
from roadwatch_simulation.geometry import Patch, box, limb, merge
from roadwatch_simulation.materials import (
    AMBER,
    BEHIND_GLASS_DARK,
    BEHIND_GLASS_SKIN,
    GLASS,
    LAMP_CLEAR,
    LAMP_LIT,
    MIRROR_GLASS,
    PIANO_BLACK,
    PLASTIC,
    SEAM,
    STEEL,
    TAIL_RED,
    UNDERBODY,
    WHITE_TRIM,
    WORK_PAINTS,
    Colour,
    paint,
    pick,
)
from roadwatch_simulation.model import Material, Model
from roadwatch_simulation.vehicles.drape import Drape
from roadwatch_simulation.vehicles.plates import add_plate, draw_plates
from roadwatch_simulation.vehicles.shapes import CAB_SHAPE
from roadwatch_simulation.vehicles.shell import Frame, Shell, build_shell, draw_frame
from roadwatch_simulation.vehicles.wheels import add_wheel, draw_wheels

LENGTH_M, WIDTH_M, HEIGHT_M = (5.8, 8.6), (2.15, 2.50), (2.85, 3.70)
DECK_M = 1.02
"""Height of the floor of the cargo box."""

TYRE_WIDTH_M = 0.27
TWIN_TYRES_M = 0.52


def build_lorry(seed: int, size: Size | None, colour: Colour | None) -> Model:
    """A box lorry; `colour` is the cab's; what is None follows from the seed."""
    rng = np.random.default_rng([seed, 102])
    bulk = float(rng.random())
    drawn = [low + (high - low) * bulk for low, high in (LENGTH_M, WIDTH_M, HEIGHT_M)]
    cab_colour, box_colour, sign_colour = (pick(WORK_PAINTS, rng) for _ in range(3))
    length, width, height = size or (round(drawn[0], 3), round(drawn[1], 3), round(drawn[2], 3))
    cab_length = min(float(rng.uniform(*CAB_SHAPE.length_m)), 0.35 * length)
    cab_height = height * float(rng.uniform(0.74, 0.86))
    frame = draw_frame(CAB_SHAPE, (cab_length, width * 0.95, cab_height), rng)
    ahead = length / 2 - cab_length / 2
    cab = _build_cab(frame, cab_colour if colour is None else colour, rng)
    assembly = Assembly()
    for patch, material, part in cab:
        assembly.add(patch.moved((ahead, 0.0, 0.0)), material, part)
    back = -length / 2
    _add_cargo(assembly, (back, length / 2 - cab_length - 0.12, width, height), box_colour, sign_colour, rng)
    _add_chassis(assembly, back, length / 2 - cab_length * 0.5, width)
    front_axle = frame.axles[0] + ahead
    _add_wheels(assembly, (front_axle, back + 0.24 * length), width, frame.wheel_radius, rng)
    plates = draw_plates(rng)
    add_plate(assembly, plates, (length / 2, 0.0, 0.62), "plate_front")
    add_plate(assembly, plates, (back, width * 0.18, 0.72), "plate_rear")
    return assembly.finish("truck", CAB_SHAPE.object_class, (length, width, height))


class _Cab(list[tuple[Patch, Material, str | None]]):
    """Patches of the cab with their materials and parts, before the cab is put in front of the box."""

    def both(self, patch: Patch, material: Material, part: str | None = None) -> None:
        """Adds a patch and its mirror image."""
        self.append((patch, material, None if part is None else f"{part}_left"))
        self.append((patch.mirrored(), material, None if part is None else f"{part}_right"))


def _build_cab(frame: Frame, colour: Colour, rng: np.random.Generator) -> _Cab:
    shell = build_shell(frame)
    materials = {"paint": paint(colour), "glass": GLASS, "trim": PLASTIC, "underbody": UNDERBODY}
    cab = _Cab()
    cab += [(shell.patch.chosen(shell.kinds == kind), material, None) for kind, material in materials.items()]
    _add_face(cab, frame, shell, rng)
    _add_cab_sides(cab, frame, shell)
    return cab


def _add_face(cab: _Cab, frame: Frame, shell: Shell, rng: np.random.Generator) -> None:
    ahead = Drape(shell.patch, 0.0)
    half, height = frame.size[1] / 2, frame.size[2]
    low = frame.shape.clearance_m
    cab.append((ahead.rectangle((-half * 0.82, half * 0.82), (low, low + 0.22)), PLASTIC, None))
    wide = float(rng.uniform(0.5, 0.72))
    grille = ahead.rectangle((-half * wide, half * wide), (low + 0.27, height * 0.385))
    cab.append((grille, PIANO_BLACK, None))
    for share in (0.35, 0.7):
        z = low + 0.27 + (height * 0.385 - low - 0.27) * share
        cab.append((ahead.stroke([(-half * wide, z), (half * wide, z)], 0.02, lift_m=0.01), STEEL, None))
    cab.both(ahead.rectangle((half * 0.58, half * 0.86), (low + 0.06, low + 0.20)), LAMP_CLEAR, "headlamp")
    cab.both(ahead.ellipse((half * 0.68, low + 0.13), (0.065, 0.055), 0.012), LAMP_LIT, "headlamp")
    cab.both(ahead.ellipse((half * 0.82, low + 0.13), (0.03, 0.05), 0.012), AMBER, "headlamp")
    cab.append((ahead.ellipse((half * 0.4, height * 0.66), (0.10, 0.13), 0.009), BEHIND_GLASS_SKIN, None))
    cab.append((ahead.ellipse((half * 0.4, height * 0.55), (0.26, 0.18), 0.007), BEHIND_GLASS_DARK, None))
    for line in ([(0.8, 0.50), (0.1, 0.53)], [(-0.05, 0.50), (-0.75, 0.53)]):
        wiper = [(half * across, height * up) for across, up in line]
        cab.append((ahead.stroke(wiper, 0.026, lift_m=0.012), PLASTIC, None))


def _add_cab_sides(cab: _Cab, frame: Frame, shell: Shell) -> None:
    side = Drape(shell.patch, 90.0)
    half, height = frame.size[1] / 2, frame.size[2]
    for u in (0.20, 0.82):
        x = frame.x(u)
        cab.both(side.stroke([(-x, frame.wheel_radius * 2.3), (-x, height * 0.90)], 0.014), SEAM)
    handle = (frame.x(0.76), half, height * 0.44)
    cab.both(box(handle, (0.2, 0.04, 0.04), 0.2), PLASTIC)
    place = (frame.x(0.05), half + 0.20, height * 0.68)
    cab.both(box(place, (0.12, 0.22, 0.44), 0.3), PLASTIC, "mirror")
    cab.both(box((place[0] - 0.063, place[1], place[2]), (0.01, 0.18, 0.38)), MIRROR_GLASS, "mirror")
    arm = limb((frame.x(0.15), half * 0.95, height * 0.84), (*place[:2], place[2] + 0.15), 0.022, 0.022, 5)
    cab.both(arm, PLASTIC, "mirror")


def _add_cargo(
    assembly: Assembly,
    extent: tuple[float, float, float, float],
    colour: Colour,
    sign: Colour,
    rng: np.random.Generator,
) -> None:
    """The cargo box from `extent`: rear end, front end, width and height (m)."""
    back, front, width, height = extent
    middle, length = (back + front) / 2 + 0.02, front - back - 0.04
    tall = height - DECK_M
    body = box((middle, 0, DECK_M + tall / 2), (length, width, tall), 0.012)
    assembly.add(body, paint(colour))
    for z in (DECK_M + 0.03, height - 0.03):
        for y in (-width / 2, width / 2):
            assembly.add(box((middle, y * 0.999, z), (length * 0.995, 0.008, 0.06)), STEEL)
    if rng.random() < 0.55:
        size = (length * float(rng.uniform(0.35, 0.7)), 0.004, tall * float(rng.uniform(0.2, 0.5)))
        assembly.add_both_sides(box((middle, width / 2, DECK_M + tall * 0.55), size), paint(sign))
    x = back + 0.018
    assembly.add(box((x, 0, DECK_M + tall / 2), (0.006, 0.025, tall * 0.96)), SEAM)
    for y in (0.16, 0.30):
        bar = box((x - 0.006, y * width, DECK_M + tall / 2), (0.03, 0.03, tall * 0.92))
        assembly.add_both_sides(bar, STEEL)
    assembly.add(box((x, 0, height - 0.04), (0.006, width * 0.98, 0.08)), STEEL)
    if rng.random() < 0.3:
        cooler = box((front + 0.12, 0, height - 0.5), (0.3, width * 0.7, 0.6), 0.2)
        assembly.add(cooler, WHITE_TRIM)


def _add_chassis(assembly: Assembly, back: float, front: float, width: float) -> None:
    middle, length = (front + back) / 2, front - back
    beams = merge([box((middle, y, 0.86), (length, 0.12, 0.28)) for y in (-0.42, 0.42)])
    assembly.add(beams, UNDERBODY)
    tank = box((front - length * 0.30, width * 0.36, 0.66), (length * 0.16, width * 0.22, 0.46), 0.3)
    assembly.add(tank, STEEL)
    crate = box((front - length * 0.30, -width * 0.36, 0.68), (length * 0.14, width * 0.22, 0.42), 0.1)
    assembly.add(crate, PLASTIC)
    assembly.add(box((back + 0.08, 0.0, 0.55), (0.10, width * 0.94, 0.14), 0.2), PLASTIC)
    carrier = box((back + 0.05, 0.0, 0.86), (0.06, width * 0.96, 0.16))
    assembly.add(carrier, PLASTIC)
    lamp = box((back + 0.02, width * 0.40, 0.86), (0.04, 0.34, 0.12), 0.2)
    assembly.add_both_sides(lamp, TAIL_RED, "taillamp")
    lens = box((back + 0.002, width * 0.36, 0.86), (0.012, 0.09, 0.10), 0.2)
    assembly.add_both_sides(lens, AMBER, "taillamp")
    guard = box((middle - length * 0.02, width * 0.47, 0.62), (length * 0.26, 0.03, 0.12), 0.2)
    assembly.add_both_sides(guard, STEEL)


def _add_wheels(
    assembly: Assembly, axles: tuple[float, float], width: float, radius: float, rng: np.random.Generator
) -> None:
    design = draw_wheels(rng, plain=0.85)
    for name, x in zip(("front", "rear"), axles, strict=True):
        for side, sign in (("left", 1.0), ("right", -1.0)):
            place = (x, sign * width * 0.468, radius)
            breadth = TWIN_TYRES_M if name == "rear" else TYRE_WIDTH_M
            add_wheel(assembly, design, place, breadth, f"tyre_{name}_{side}")
    flap = box((axles[1] - radius - 0.12, width * 0.40, 0.5), (0.02, 0.5, 0.5))
    assembly.add_both_sides(flap, PLASTIC)
