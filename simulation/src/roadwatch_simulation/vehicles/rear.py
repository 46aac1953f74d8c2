"""The back of a car: tail lamps, boot seam, plate, bumper, exhausts, brake light and rear wiper."""

from __future__ import annotations

import numpy as np

from roadwatch_simulation.assembly import Assembly
from roadwatch_simulation.geometry import tube
from roadwatch_simulation.materials import (
    AMBER,
    CHROME,
    GLASS,
    LAMP_CLEAR,
    PLASTIC,
    PRIVACY_GLASS,
    SEAM,
    STEEL,
    TAIL_BRIGHT,
    TAIL_RED,
)
from roadwatch_simulation.vehicles.drape import Drape
from roadwatch_simulation.vehicles.lamps import Outline, corner_lamp
from roadwatch_simulation.vehicles.look import Look
from roadwatch_simulation.vehicles.plates import PlateStyle, add_plate
from roadwatch_simulation.vehicles.shell import Frame, Shell

LAMP_VIEW_DEG = 180.0 - 40.0

WIDE_LAMPS: tuple[Outline, ...] = (
    ((0.0, -0.050, 0.050), (0.6, -0.075, 0.070), (1.0, -0.02, 0.065)),
    ((0.0, -0.035, 0.040), (0.5, -0.060, 0.055), (1.0, -0.01, 0.050)),
    ((0.0, -0.075, 0.065), (0.9, -0.085, 0.070), (1.0, -0.06, 0.055)),
    ((0.0, -0.025, 0.045), (0.4, -0.050, 0.060), (0.7, -0.11, 0.065), (1.0, -0.03, 0.060)),
)
TALL_LAMPS: tuple[Outline, ...] = (
    ((0.0, -0.10, 0.10), (0.5, -0.15, 0.16), (1.0, -0.08, 0.18)),
    ((0.0, -0.07, 0.06), (0.45, -0.13, 0.09), (0.6, -0.14, 0.26), (1.0, -0.04, 0.28)),
    ((0.0, -0.14, 0.12), (1.0, -0.12, 0.14)),
    ((0.0, -0.06, 0.06), (0.6, -0.09, 0.09), (1.0, -0.03, 0.09)),
)


def add_rear(assembly: Assembly, frame: Frame, shell: Shell, look: Look, plates: PlateStyle) -> None:
    """Adds everything behind."""
    behind = Drape(shell.patch, 180.0)
    top = frame.roof(0.988)
    bottom = frame.floor(1.0) + 0.005
    _add_tail_lamps(assembly, frame, shell, look, top)
    _add_boot(assembly, frame, behind, look, top, bottom)
    _add_bumper(assembly, frame, behind, look, bottom)
    low = look.plate_on_bumper or frame.shape.bed is not None
    height = bottom + 0.27 if low else bottom + (top - bottom) * 0.60
    _add_rear_plate(assembly, frame, behind, plates, min(height, 1.0))


def _add_tail_lamps(assembly: Assembly, frame: Frame, shell: Shell, look: Look, top: float) -> None:
    corner = Drape(shell.painted(frame.x(1.0), frame.x(0.80)), LAMP_VIEW_DEG)
    half = frame.size[1] / 2
    tall = frame.shape.hatch or frame.shape.bed is not None
    height = min(top, 1.12) - (0.20 if tall else 0.125)
    reach = 0.74 if tall else 0.56
    inner = (frame.x(1.0), half * reach, height - 0.01)
    outer = (frame.x(0.955 if tall else 0.94), half * 0.97, height + 0.03)
    outline = (TALL_LAMPS if tall else WIDE_LAMPS)[look.tail_style]
    inset = [(at, low * 0.6, high * 0.6) for at, low, high in outline]
    assembly.add_both_sides(corner_lamp(corner, inner, outer, outline), TAIL_RED, "taillamp")
    lens = corner_lamp(corner, inner, outer, inset, (0.40, 0.85), 0.009)
    assembly.add_both_sides(lens, TAIL_BRIGHT, "taillamp")
    white = corner_lamp(corner, inner, outer, inset, (0.06, 0.30), 0.009)
    assembly.add_both_sides(white, AMBER if look.tail_style == 1 else LAMP_CLEAR, "taillamp")
    if look.tail_bar:
        behind = Drape(shell.patch, 180.0)
        bar = behind.rectangle((-half * reach, half * reach), (height - 0.03, height + 0.02))
        assembly.add(bar, TAIL_RED)


def _add_boot(
    assembly: Assembly, frame: Frame, behind: Drape, look: Look, top: float, bottom: float
) -> None:
    half = frame.size[1] / 2
    seam_height = bottom + 0.34
    width = half * (0.80 if frame.shape.hatch else 0.72)
    seam = [(-width, top - 0.04), (-width, seam_height + 0.05), (-width + 0.05, seam_height),
            (width - 0.05, seam_height), (width, seam_height + 0.05), (width, top - 0.04)]  # fmt: skip
    assembly.add(behind.stroke(seam, 0.010), SEAM)
    if look.chrome:
        handle = bottom + (top - bottom) * 0.60 + 0.10
        bar = behind.stroke([(-half * 0.35, handle), (half * 0.35, handle)], 0.022, lift_m=0.01)
        assembly.add(bar, CHROME)
    badge = behind.ellipse((0.0, top - 0.12), (0.050, 0.042), 0.010)
    assembly.add(badge, CHROME)
    name = behind.rectangle((half * 0.40, half * 0.58), (top - 0.20, top - 0.18))
    assembly.add(name, CHROME)
    window = frame.shape.rear_window
    if window is None:
        _add_rear_doors(assembly, frame, behind, look, bottom)
        return
    stop = frame.roof(window[0]) - 0.03
    assembly.add(behind.rectangle((-0.16, 0.16), (stop - 0.012, stop + 0.012)), TAIL_BRIGHT)
    if frame.shape.hatch:
        foot = frame.roof(window[1]) + 0.02
        assembly.add(behind.stroke([(0.02, foot), (-0.34, foot + 0.07)], 0.018, lift_m=0.012), PLASTIC)


def _add_rear_doors(
    assembly: Assembly, frame: Frame, behind: Drape, look: Look, bottom: float
) -> None:
    """Two wing doors of a van, glazed on some."""
    height, half = frame.size[2], frame.size[1] / 2
    if look.tail_style != 0:
        pane = behind.rectangle((half * 0.09, half * 0.72), (height * 0.55, height * 0.84), 0.12)
        assembly.add_both_sides(pane, PRIVACY_GLASS if look.privacy_glass else GLASS)
    assembly.add(behind.stroke([(0.0, bottom + 0.3), (0.0, height * 0.96)], 0.014), SEAM)
    assembly.add(behind.rectangle((-0.16, 0.16), (height * 0.935, height * 0.95)), TAIL_BRIGHT)


def _add_bumper(assembly: Assembly, frame: Frame, behind: Drape, look: Look, bottom: float) -> None:
    half = frame.size[1] / 2
    line = np.linspace(-0.74, 0.74, 15)
    rise = 0.16 if frame.shape.rugged else 0.10
    assembly.add(
        behind.sheet([(x * half, bottom + 0.002) for x in line],
                     [(x * half, bottom + rise - 0.04 * x * x) for x in line], 3), PLASTIC)  # fmt: skip
    crease = [(x * half, bottom + 0.30) for x in line]
    assembly.add(behind.stroke(crease, 0.008), SEAM)
    reflector = behind.rectangle((half * 0.58, half * 0.82), (bottom + 0.12, bottom + 0.155))
    assembly.add_both_sides(reflector, TAIL_RED)
    for number in range(look.exhausts):
        side = 1.0 if number else -1.0
        pipe = tube((frame.x(0.94), 0, 0), (frame.x(0.997), 0, 0), 0.036, 8)
        assembly.add(pipe.moved((0.0, side * half * 0.62, bottom + 0.015)), STEEL)


def _add_rear_plate(
    assembly: Assembly, frame: Frame, behind: Drape, plates: PlateStyle, height: float
) -> None:
    wide, tall = plates.width / 2 + 0.06, plates.height / 2 + 0.035
    assembly.add(behind.rectangle((-wide, wide), (height - tall, height + tall)), PLASTIC)
    placed, met = behind.onto(
        np.array([[y, height + z] for y in (-0.2, 0.0, 0.2) for z in (-plates.height / 2, plates.height / 2)])
    )
    x = float(placed[met, 0].min(initial=frame.x(0.97)))
    add_plate(assembly, plates, (x, 0.0, height), "plate_rear")
