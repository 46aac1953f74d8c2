"""The face of a car: headlamps, grille, intakes, fog lamps, badge and front plate."""

from __future__ import annotations

import numpy as np

from roadwatch_simulation.assembly import Assembly
from roadwatch_simulation.materials import (
    AMBER,
    CHROME,
    LAMP_CLEAR,
    LAMP_LIT,
    LAMP_SMOKED,
    PIANO_BLACK,
    PLASTIC,
    SEAM,
)
from roadwatch_simulation.vehicles.drape import Drape
from roadwatch_simulation.vehicles.lamps import Outline, corner_lamp
from roadwatch_simulation.vehicles.look import Look
from roadwatch_simulation.vehicles.plates import PlateStyle, add_plate
from roadwatch_simulation.vehicles.shell import Frame, Shell

LAMP_VIEW_DEG = 38.0
"""Headlamps are drawn from this far round the corner, so that they show from the front and the side."""

HEADLAMPS: tuple[Outline, ...] = (
    ((0.0, -0.045, 0.045), (0.3, -0.075, 0.065), (0.7, -0.070, 0.085), (1.0, 0.02, 0.075)),
    ((0.0, -0.020, 0.035), (0.4, -0.045, 0.050), (0.8, -0.020, 0.070), (1.0, 0.03, 0.055)),
    ((0.0, -0.070, 0.060), (0.1, -0.080, 0.070), (0.85, -0.080, 0.070), (1.0, -0.06, 0.060)),
    ((0.0, -0.060, 0.020), (0.4, -0.075, 0.055), (0.75, -0.060, 0.080), (1.0, 0.01, 0.095)),
)


def add_front(assembly: Assembly, frame: Frame, shell: Shell, look: Look, plates: PlateStyle) -> None:
    """Adds everything that makes the front of a car look at you."""
    ahead = Drape(shell.patch, 0.0)
    lip = frame.roof(0.03)
    bottom = frame.floor(0.0) + 0.005
    _add_headlamps(assembly, frame, shell, look, lip)
    _add_grille(assembly, frame, ahead, look, lip)
    _add_bumper(assembly, frame, ahead, look, bottom)
    _add_front_plate(assembly, frame, ahead, plates, bottom + (lip - bottom) * 0.42)


def _add_headlamps(assembly: Assembly, frame: Frame, shell: Shell, look: Look, lip: float) -> None:
    corner = Drape(shell.painted(frame.x(0.25), frame.x(0.0)), LAMP_VIEW_DEG)
    height = lip - 0.115
    half = frame.size[1] / 2
    inner = (frame.x(0.0), half * 0.50, height - 0.01)
    outer = (frame.x(0.085), half * 0.96, height + 0.035)
    tall = look.lamp_height
    outline = [(at, low * tall, high * tall) for at, low, high in HEADLAMPS[look.lamp_style]]
    smoked = look.lamp_style in (1, 3)
    shell_glass = corner_lamp(corner, inner, outer, outline)
    assembly.add_both_sides(shell_glass, LAMP_SMOKED if smoked else LAMP_CLEAR, "headlamp")
    inset = [(at, low * 0.70, high * 0.70) for at, low, high in outline]
    for middle, reach in ((0.24, 0.13), (0.56, 0.15)):
        oval, span = _round(inset, middle, reach), (middle - reach, middle + reach)
        bowl = corner_lamp(corner, inner, outer, oval, span, 0.008)
        assembly.add_both_sides(bowl, LAMP_CLEAR if smoked else LAMP_SMOKED, "headlamp")
        bulb_reach = reach * 0.55
        spot = _round([(at, low * 0.55, high * 0.55) for at, low, high in inset], middle, bulb_reach)
        bulb = corner_lamp(corner, inner, outer, spot, (middle - bulb_reach, middle + bulb_reach), 0.011)
        assembly.add_both_sides(bulb, LAMP_LIT, "headlamp")
    assembly.add_both_sides(corner_lamp(corner, inner, outer, inset, (0.80, 0.93), 0.008), AMBER, "headlamp")


def _round(outline: Outline, middle: float, reach: float) -> Outline:
    """The part of an outline around `middle`, drawn in to an oval of half length `reach`."""
    table = np.array(outline)
    ovals = []
    for turn in np.linspace(-1.0, 1.0, 9):
        at = middle + reach * turn
        low, high = (float(np.interp(at, table[:, 0], table[:, column])) for column in (1, 2))
        center, half = (low + high) / 2, (high - low) / 2 * float(np.sqrt(max(1.0 - turn * turn, 0.0)))
        ovals.append((at, center - half, center + half))
    return ovals


def _add_grille(assembly: Assembly, frame: Frame, ahead: Drape, look: Look, lip: float) -> None:
    half = frame.size[1] / 2 * look.grille_width
    tall = (0.15 if frame.shape.rugged else 0.10) * look.grille_height
    top = lip - 0.055
    narrow = (1.0, 0.82, 0.9, 0.7, 1.12)[look.grille_style]
    across = np.linspace(-1.0, 1.0, 17)
    lower = [(x * half * narrow, top - tall) for x in across]
    upper = [(x * half, top - 0.02 * x * x) for x in across]
    assembly.add(ahead.sheet(lower, upper, 4), PIANO_BLACK)
    if look.chrome:
        assembly.add(ahead.stroke(upper, 0.022, lift_m=0.010), CHROME)
        assembly.add(ahead.stroke(lower, 0.014, lift_m=0.010), CHROME)
    bars = (2, 3, 0, 1, 4)[look.grille_style]
    for number in range(bars):
        height = top - tall * (number + 1) / (bars + 1)
        line = [(-half * 0.95, height), (half * 0.95, height)]
        assembly.add(ahead.stroke(line, 0.011, lift_m=0.009), CHROME if look.chrome else PLASTIC)
    badge = ahead.ellipse((0.0, top - min(tall * 0.45, 0.06)), (0.055, 0.045), 0.014)
    assembly.add(badge, CHROME)
    seam = [(x * frame.size[1] * 0.38, top + 0.03 - 0.02 * x * x) for x in across]
    assembly.add(ahead.stroke(seam, 0.009), SEAM)


def _add_bumper(assembly: Assembly, frame: Frame, ahead: Drape, look: Look, bottom: float) -> None:
    half = frame.size[1] / 2
    height = 0.13 if look.grille_style in (0, 3) else 0.09
    across = np.linspace(-1.0, 1.0, 15)
    lower = [(x * half * 0.62, bottom + 0.035) for x in across]
    upper = [(x * half * 0.55, bottom + 0.035 + height) for x in across]
    assembly.add(ahead.sheet(lower, upper, 3), PLASTIC)
    lip = [(x * half * 0.80, bottom + 0.012) for x in across]
    assembly.add(ahead.stroke(lip, 0.025, lift_m=0.012), PLASTIC)
    pocket = ahead.rectangle((half * 0.66, half * 0.84), (bottom + 0.05, bottom + 0.17))
    assembly.add_both_sides(pocket, PLASTIC)
    fog = ahead.ellipse((half * 0.75, bottom + 0.11), (0.045, 0.040), 0.010)
    assembly.add_both_sides(fog, LAMP_CLEAR)


def _add_front_plate(
    assembly: Assembly, frame: Frame, ahead: Drape, plates: PlateStyle, height: float
) -> None:
    placed, met = ahead.onto(
        np.array([[y, height + z] for y in (-0.2, 0.0, 0.2) for z in (-plates.height / 2, plates.height / 2)])
    )
    x = float(placed[met, 0].max(initial=frame.x(0.0)))
    add_plate(assembly, plates, (x, 0.0, height), "plate_front")
