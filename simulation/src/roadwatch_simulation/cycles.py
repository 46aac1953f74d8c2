"""Bicycles and motorcycles without their riders; they tell where a rider sits, holds on and treads."""

from __future__ import annotations

import numpy as np

from roadwatch_simulation.assembly import Assembly
from roadwatch_simulation.geometry import Patch, box, ellipsoid, lathe, limb, merge, rotation, tube
from roadwatch_simulation.materials import (
    AMBER,
    CHROME,
    LAMP_LIT,
    PLASTIC,
    RIM,
    SEAM,
    STEEL,
    TAIL_BRIGHT,
    TYRE,
    Colour,
    paint,
)
from roadwatch_simulation.vehicles.plates import add_plate, draw_plates

Seat = dict[str, np.ndarray]

UPRIGHT = rotation("x", -np.pi / 2)
CRANK_M = 0.17


def _wheel_rim(radius: float, half_width: float) -> Patch:
    """A tyre as a ring about y."""
    angles = np.linspace(0.0, 2.0 * np.pi, 7)
    profile = [
        (radius - half_width + half_width * float(np.cos(a)), half_width * float(np.sin(a))) for a in angles
    ]
    return lathe(profile, 26, 80.0).turned(UPRIGHT)


def _spokes(radius: float, count: int, thickness: float) -> Patch:
    rods = []
    for number in range(count):
        angle = 2.0 * np.pi * number / count
        tip = (radius * np.cos(angle), 0.0, radius * np.sin(angle))
        rods.append(tube((0.0, 0.0, 0.0), tip, thickness, 3))
    return merge(rods)


def add_bicycle(assembly: Assembly, colour: Colour, phase: float, rng: np.random.Generator) -> Seat:
    """A bicycle with its crank at `phase` (rad)."""
    radius = float(rng.uniform(0.325, 0.35))
    rear, front = np.array([-0.52, 0.0, radius]), np.array([0.54, 0.0, radius])
    for center, part in ((rear, "tyre_rear"), (front, "tyre_front")):
        assembly.add(_wheel_rim(radius, float(0.022)).moved(center), TYRE, part)
        assembly.add(_wheel_rim(radius - 0.035, 0.010).moved(center), RIM, part)
        assembly.add(_spokes(radius - 0.04, 14, 0.0022).moved(center), STEEL, part)
        assembly.add(ellipsoid(center, (0.03, 0.05, 0.03), 8, 5), STEEL, part)
    bracket, saddle = np.array([-0.08, 0.0, 0.28]), np.array([-0.24, 0.0, float(rng.uniform(0.92, 1.0))])
    head, bars = np.array([0.38, 0.0, 0.86]), np.array([0.37, 0.0, float(rng.uniform(1.0, 1.12))])
    low_head = head + (front - head) * 0.22
    post = bracket + (saddle - bracket) * 0.72
    step_through = bool(rng.random() < 0.35)
    pairs = [(bracket, post), (bracket, low_head), (bracket, rear)]
    pairs += [(post, rear), (low_head, front), (head, low_head)]
    pairs.append((bracket + (post - bracket) * 0.45, low_head) if step_through else (post, head))
    frame = merge([limb(a, b, 0.017, 0.016, 7) for a, b in pairs])
    assembly.add(frame, paint(colour))
    assembly.add(merge([tube(post, saddle, 0.013), tube(head, bars, 0.014)]), STEEL)
    assembly.add(ellipsoid(saddle + [0.0, 0.0, 0.01], (0.14, 0.075, 0.035), 10, 5), PLASTIC)
    seat: Seat = {"saddle": saddle + [0.0, 0.0, 0.02]}
    _add_handlebar(assembly, bars, seat)
    _add_cranks(assembly, bracket, phase, seat)
    if rng.random() < 0.5:
        _add_carrier(assembly, rear, radius)
    assembly.add(ellipsoid(head + [0.06, 0.0, 0.02], (0.04, 0.04, 0.04), 8, 5), LAMP_LIT)
    return seat


def _add_handlebar(assembly: Assembly, bars: np.ndarray, seat: Seat) -> None:
    for name, side in (("left", 1.0), ("right", -1.0)):
        grip = bars + np.array([-0.03, side * 0.29, 0.01])
        assembly.add(limb(bars, grip, 0.014, 0.014, 6), STEEL)
        assembly.add(limb(grip, grip + np.array([-0.07, side * 0.02, 0.0]), 0.018, 0.018, 6), PLASTIC)
        seat[f"grip_{name}"] = grip + np.array([-0.03, 0.0, 0.02])


def _add_cranks(assembly: Assembly, bracket: np.ndarray, phase: float, seat: Seat) -> None:
    ring = lathe([(0.0, -0.006), (0.095, -0.006), (0.095, 0.006), (0.0, 0.006)], 16).turned(UPRIGHT)
    assembly.add(ring.moved(bracket + np.array([0.0, -0.05, 0.0])), STEEL)
    for name, side, turn in (("left", 1.0, phase), ("right", -1.0, phase + np.pi)):
        arm = CRANK_M * np.array([np.cos(turn), 0.0, np.sin(turn)])
        start = bracket + np.array([0.0, side * 0.07, 0.0])
        pedal = start + arm + np.array([0.0, side * 0.06, 0.0])
        assembly.add(limb(start, start + arm, 0.014, 0.012, 5), STEEL)
        assembly.add(box(pedal, (0.10, 0.09, 0.022), 0.2), PLASTIC)
        seat[f"pedal_{name}"] = pedal + np.array([0.0, 0.0, 0.02])


def _add_carrier(assembly: Assembly, rear: np.ndarray, radius: float) -> None:
    top = np.array([rear[0] + 0.05, 0.0, 2.0 * radius + 0.06])
    assembly.add(box(top, (0.42, 0.13, 0.015)), STEEL)
    assembly.add(merge([tube(rear + [0, y, 0], top + [0, y, 0], 0.007, 4) for y in (-0.06, 0.06)]), STEEL)
    assembly.add(box(top + [-0.23, 0.0, -0.03], (0.02, 0.08, 0.05), 0.2), TAIL_BRIGHT)


def add_motorcycle(assembly: Assembly, colour: Colour, rng: np.random.Generator) -> Seat:
    """A motorcycle or, in one case out of three, a scooter."""
    scooter = bool(rng.random() < 0.33)
    radius = float(rng.uniform(0.24, 0.27)) if scooter else float(rng.uniform(0.30, 0.33))
    half = 0.66 if scooter else 0.70
    rear, front = np.array([-half, 0.0, radius]), np.array([half, 0.0, radius])
    for center, part in ((rear, "tyre_rear"), (front, "tyre_front")):
        assembly.add(_wheel_rim(radius, 0.062).moved(center), TYRE, part)
        assembly.add(_spokes(radius * 0.72, 5, 0.018).moved(center), RIM, part)
        assembly.add(ellipsoid(center, (0.09, 0.05, 0.09), 10, 5), STEEL, part)
    bars = np.array([0.36, 0.0, 1.02])
    fork = merge([limb(front + [0, y, 0], bars + [0.02, y, -0.08], 0.026, 0.026, 7) for y in (-0.09, 0.09)])
    assembly.add(fork, STEEL)
    guard = ellipsoid(front + [0.0, 0.0, radius * 0.62], (radius * 0.9, 0.075, radius * 0.5), 12, 6)
    assembly.add(guard, paint(colour))
    (_add_scooter_body if scooter else _add_motorcycle_body)(assembly, colour, rear)
    _add_lights(assembly, bars, rng)
    saddle = np.array([-0.22, 0.0, 0.80])
    seat: Seat = {"saddle": saddle}
    for name, side in (("left", 1.0), ("right", -1.0)):
        grip = bars + np.array([-0.10, side * 0.34, 0.02])
        assembly.add(limb(bars, grip, 0.016, 0.016, 6), STEEL)
        seat[f"grip_{name}"] = grip
        foot = np.array([0.25, side * 0.16, 0.36]) if scooter else np.array([-0.08, side * 0.22, 0.36])
        seat[f"pedal_{name}"] = foot
        glass = bars + np.array([-0.02, side * 0.30, 0.20])
        assembly.add(limb(bars + [0.0, side * 0.24, 0.02], glass, 0.008, 0.008, 4), PLASTIC)
        assembly.add(ellipsoid(glass, (0.02, 0.065, 0.045), 8, 5), PLASTIC)
    return seat


def _add_motorcycle_body(assembly: Assembly, colour: Colour, rear: np.ndarray) -> None:
    coat = paint(colour)
    assembly.add(ellipsoid((0.12, 0.0, 0.82), (0.27, 0.145, 0.145), 14, 8), coat)
    assembly.add(box((0.05, 0.0, 0.46), (0.42, 0.26, 0.32), 0.3), STEEL)
    assembly.add(box((0.18, 0.0, 0.60), (0.16, 0.34, 0.18), 0.3), PLASTIC)
    assembly.add(box((-0.33, 0.0, 0.76), (0.62, 0.25, 0.10), 0.45), PLASTIC)
    assembly.add(box((-0.38, 0.0, 0.66), (0.50, 0.20, 0.14), 0.4), coat)
    assembly.add(limb((-0.62, 0.0, 0.74), (-0.84, 0.0, 0.80), 0.07, 0.04), coat)
    assembly.add(merge([limb((-0.1, y, 0.36), rear + [0, y, 0], 0.035, 0.03, 6) for y in (-0.1, 0.1)]), STEEL)
    assembly.add(limb((0.15, -0.16, 0.26), (-0.30, -0.19, 0.30), 0.035, 0.045), CHROME)
    assembly.add(limb((-0.30, -0.19, 0.30), (-0.78, -0.19, 0.42), 0.05, 0.055), CHROME)
    assembly.add(box((0.42, 0.0, 0.98), (0.16, 0.30, 0.26), 0.4), coat)


def _add_scooter_body(assembly: Assembly, colour: Colour, rear: np.ndarray) -> None:
    coat = paint(colour)
    assembly.add(ellipsoid((-0.42, 0.0, 0.58), (0.44, 0.19, 0.20), 14, 8), coat)
    assembly.add(box((-0.33, 0.0, 0.77), (0.66, 0.28, 0.10), 0.45), PLASTIC)
    assembly.add(box((0.14, 0.0, 0.30), (0.62, 0.34, 0.09), 0.3), PLASTIC)
    shield = box((0.0, 0.0, 0.0), (0.09, 0.42, 0.62), 0.45).turned(rotation("y", -0.25))
    assembly.add(shield.moved((0.42, 0.0, 0.64)), coat)
    assembly.add(box((0.38, 0.0, 1.0), (0.20, 0.30, 0.16), 0.4), coat)
    assembly.add(box(rear + [0.05, -0.13, 0.06], (0.42, 0.10, 0.16), 0.4), STEEL)


def _add_lights(assembly: Assembly, bars: np.ndarray, rng: np.random.Generator) -> None:
    lamp = bars + np.array([0.14, 0.0, -0.06])
    assembly.add(ellipsoid(lamp, (0.05, 0.09, 0.085), 12, 6), LAMP_LIT, "headlamp")
    assembly.add(box((-0.88, 0.0, 0.74), (0.03, 0.14, 0.06), 0.3), TAIL_BRIGHT, "taillamp")
    blinkers = [ellipsoid((x, y, z), (0.025, 0.035, 0.025), 6, 4)
                for x, z in ((-0.84, 0.70), (bars[0] + 0.08, 0.92)) for y in (-0.17, 0.17)]  # fmt: skip
    assembly.add(merge(blinkers), AMBER)
    assembly.add(box((-0.86, 0.0, 0.62), (0.02, 0.16, 0.22), 0.1), SEAM)
    style = draw_plates(rng)
    square = type(style)(0.20, 0.15, style.front, style.rear, False, style.letters)
    add_plate(assembly, square, (-0.872, 0.0, 0.58), "plate_rear")
