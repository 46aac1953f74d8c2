"""What shows through a car's windows: seats, people, the street beyond; laid on the glass as flat shapes.

Real glass shows a dim picture of the inside under its reflections. Sheets with the gloss of glass and the
colour of what is behind do the same without transparency.
"""

from __future__ import annotations

import numpy as np

from roadwatch_simulation.assembly import Assembly
from roadwatch_simulation.materials import (
    BEHIND_GLASS_DARK,
    BEHIND_GLASS_PALE,
    BEHIND_GLASS_SKIN,
    SEEN_THROUGH,
)
from roadwatch_simulation.vehicles.drape import Drape
from roadwatch_simulation.vehicles.look import Look
from roadwatch_simulation.vehicles.shell import Frame, Shell

FAR_M = 0.003
NEAR_M = 0.006
NEAREST_M = 0.009


def add_cabin(assembly: Assembly, frame: Frame, shell: Shell, look: Look) -> None:
    """Adds the dim inside to the windscreen, the rear window and the side windows."""
    _add_ahead(assembly, frame, Drape(shell.patch, 0.0), look)
    _add_behind(assembly, frame, Drape(shell.patch, 180.0), look)
    _add_sides(assembly, frame, Drape(shell.patch, 90.0), look)


def _add_ahead(assembly: Assembly, frame: Frame, ahead: Drape, look: Look) -> None:
    low, high = (frame.roof(u) for u in frame.shape.windscreen)
    tall, half = high - low, frame.size[1] / 2
    if look.seen_through and frame.shape.rear_window:
        pale = ahead.rectangle((-half * 0.42, half * 0.42), (low + 0.48 * tall, low + 0.78 * tall))
        assembly.add(pale, SEEN_THROUGH)
    seat = half * 0.40
    for side in (-1.0, 1.0):
        assembly.add(ahead.ellipse((side * seat, low + 0.60 * tall), (0.13, 0.10), NEAR_M), BEHIND_GLASS_DARK)
        back = ahead.mound((side * seat, low + 0.10 * tall), 0.25, 0.44 * tall, NEAR_M)
        assembly.add(back, BEHIND_GLASS_DARK)
    sides = [1.0 if look.wheel_on_left else -1.0] if look.driver else []
    sides += [-side for side in sides if look.passengers > 1]
    for side in sides:
        head = ahead.ellipse((side * seat, low + 0.60 * tall), (0.075, 0.105), NEAREST_M)
        assembly.add(head, BEHIND_GLASS_SKIN)
        body = ahead.mound((side * seat, low + 0.10 * tall), 0.21, 0.36 * tall, NEAREST_M)
        assembly.add(body, BEHIND_GLASS_PALE)


def _add_behind(assembly: Assembly, frame: Frame, behind: Drape, look: Look) -> None:
    window = frame.shape.rear_window
    if window is None or look.privacy_glass:
        return
    high, low = (frame.roof(u) for u in window)
    tall, half = high - low, frame.size[1] / 2
    if tall < 0.1:
        return
    if look.seen_through:
        pale = behind.rectangle((-half * 0.45, half * 0.45), (low + 0.35 * tall, low + 0.80 * tall))
        assembly.add(pale, SEEN_THROUGH)
    for side in (-1.0, 1.0):
        rest = behind.ellipse((side * half * 0.42, low + 0.40 * tall), (0.13, 0.22 * tall), NEAR_M)
        assembly.add(rest, BEHIND_GLASS_DARK)


def _add_sides(assembly: Assembly, frame: Frame, side: Drape, look: Look) -> None:
    for number, window in enumerate(frame.shape.side_windows):
        if number > 0 and look.privacy_glass:
            return
        _add_window(assembly, frame, side, look, window, number)


def _add_window(
    assembly: Assembly, frame: Frame, side: Drape, look: Look, window: tuple[float, float], number: int
) -> None:
    """The street beyond, a seat, and perhaps somebody, in one side window."""
    margin = (window[1] - window[0]) * 0.08
    us = np.linspace(window[0] + margin, window[1] - margin, 9)
    feet = np.array([frame.belt(u) for u in us])
    tops = np.array([frame.roof(u) for u in us]) - 0.085 * frame.size[2]
    if look.seen_through and (tops - feet).max() > 0.1:
        lower = [(-frame.x(u), foot + 0.03) for u, foot in zip(us, feet, strict=True)]
        upper = [(-frame.x(u), max(top, foot + 0.031)) for u, top, foot in zip(us, tops, feet, strict=True)]
        assembly.add_both_sides(side.sheet(lower, upper, 3, FAR_M), SEEN_THROUGH)
    if number > 1:
        return
    u = window[0] + (window[1] - window[0]) * (0.80 if number == 0 else 0.72)
    x, belt = frame.x(u), frame.belt(u)
    tall = frame.roof(u) - belt
    assembly.add_both_sides(side.mound((-x, belt + 0.03), 0.16, 0.50 * tall, NEAR_M), BEHIND_GLASS_DARK)
    assembly.add_both_sides(side.ellipse((-x, belt + 0.58 * tall), (0.07, 0.10), NEAR_M), BEHIND_GLASS_DARK)
    if look.driver and number == 0:
        at = -x - 0.14
        head = side.ellipse((at, belt + 0.52 * tall), (0.085, 0.105), NEAREST_M)
        assembly.add_both_sides(head, BEHIND_GLASS_SKIN)
        chest = side.mound((at, belt + 0.03), 0.15, 0.34 * tall, NEAREST_M)
        assembly.add_both_sides(chest, BEHIND_GLASS_PALE)
