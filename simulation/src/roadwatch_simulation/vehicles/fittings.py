"""What hangs on the sides and the roof of a car: mirrors, door gaps, handles, rails, aerials, wipers."""

from __future__ import annotations

import numpy as np

from roadwatch_simulation.assembly import Assembly
from roadwatch_simulation.geometry import box, ellipsoid, limb, merge, rotation, tube
from roadwatch_simulation.materials import CHROME, MIRROR_GLASS, PLASTIC, PRIVACY_GLASS, SEAM, TAIL_RED, paint
from roadwatch_simulation.vehicles.drape import Drape
from roadwatch_simulation.vehicles.look import Look
from roadwatch_simulation.vehicles.shapes import SHAPES
from roadwatch_simulation.vehicles.shell import Frame, Shell

SEAM_M = 0.011


def add_fittings(assembly: Assembly, frame: Frame, shell: Shell, look: Look) -> None:
    """Adds everything on the sides and on top."""
    side = Drape(shell.patch, 90.0)
    _add_mirrors(assembly, frame, look)
    _add_door_gaps(assembly, frame, side)
    _add_handles(assembly, frame, side, look)
    if len(frame.shape.side_windows) == 1 and look.passengers > 0:
        _add_crew_windows(assembly, frame, side, look)
    _add_cladding(assembly, frame, side, look)
    _add_roof(assembly, frame, look)
    _add_wipers(assembly, frame, shell)


def _add_mirrors(assembly: Assembly, frame: Frame, look: Look) -> None:
    u = frame.shape.side_windows[0][0] + 0.012
    tall = 0.26 if frame.shape is SHAPES["van"] else 0.15 if frame.shape.rugged else 0.135
    x, z = frame.x(u), frame.belt(u) + 0.045 + tall / 2
    y = frame.half_width(u) * 0.94
    cover = ellipsoid((0, 0, 0), (0.075, 0.115, tall / 2), 10, 6)
    squared = box((0, 0, 0), (0.10, 0.20, tall), 0.35)
    housing = cover if look.lamp_style % 2 else squared
    place = (x, y + 0.135, z)
    body = PLASTIC if frame.shape.rugged and look.dark_roof else paint(look.colour)
    assembly.add_both_sides(housing.turned(rotation("z", 0.25)).moved(place), body, "mirror")
    glass = box((-0.062, 0, 0), (0.012, 0.165, tall * 0.78), 0.2).turned(rotation("z", 0.25))
    assembly.add_both_sides(glass.moved(place), MIRROR_GLASS, "mirror")
    arm = limb((x + 0.02, y - 0.02, z - tall * 0.42), (x + 0.01, y + 0.09, z - tall * 0.25), 0.028, 0.022, 6)
    assembly.add_both_sides(arm, PLASTIC, "mirror")


def _door_edges(frame: Frame) -> list[float]:
    """Where doors begin and end along the car (u)."""
    windows = frame.shape.side_windows
    if len(windows) == 1:
        return [windows[0][0] + 0.012, windows[0][1] + 0.008, 0.60]
    edges = [windows[0][0] - 0.004, (windows[0][1] + windows[1][0]) / 2]
    return [*edges, windows[1][1] + 0.006] if frame.shape.doors == 2 else edges


def _add_door_gaps(assembly: Assembly, frame: Frame, side: Drape) -> None:
    sill = frame.shape.clearance_m + 0.09
    low_edges = []
    for u in _door_edges(frame):
        x, foot = frame.x(u), sill
        for axle in frame.axles:
            away = abs(x - axle)
            if away < frame.arch_radius + 0.03:
                foot = frame.wheel_radius + float(np.sqrt((frame.arch_radius + 0.03) ** 2 - away**2))
        framed = len(frame.shape.side_windows) == 1
        top = frame.belt(u) + (0.85 * (frame.roof(u) - frame.belt(u)) if framed else 0.01)
        bow = 0.015
        line = [(-x, foot), (-x - bow, (foot + top) / 2), (-x, top)]
        assembly.add_both_sides(side.stroke(line, SEAM_M), SEAM)
        low_edges.append(-x)
    sill_line = [(low_edges[0], sill), (low_edges[-1], sill)]
    rear_arch = -frame.axles[1] - frame.arch_radius - 0.03
    sill_line[1] = (min(sill_line[1][0], rear_arch), sill)
    assembly.add_both_sides(side.stroke(sill_line, SEAM_M), SEAM)


def _add_crew_windows(assembly: Assembly, frame: Frame, side: Drape, look: Look) -> None:
    """Windows in the load space of a van: in the sliding door, and on some all the way back."""
    spans = ((0.385, 0.58), (0.625, 0.80), (0.82, 0.95))[: 1 if look.passengers == 1 else 3]
    for span in spans:
        near, far = -frame.x(span[0]), -frame.x(span[1])
        low, high = (frame.size[2] * share for share in (0.50, 0.845))
        assembly.add_both_sides(side.rectangle((near, far), (low, high), 0.15), PRIVACY_GLASS)


def _add_handles(assembly: Assembly, frame: Frame, side: Drape, look: Look) -> None:
    edges = _door_edges(frame)[1:]
    material = paint(look.colour) if look.painted_handles else (CHROME if look.chrome else PLASTIC)
    for u in edges:
        x, z = frame.x(u) + 0.15, frame.belt(u) - 0.085
        placed, met = side.onto(np.array([[-x, z]]))
        if not met[0]:
            continue
        y = float(placed[0, 1])
        assembly.add_both_sides(box((x, y + 0.014, z), (0.19, 0.022, 0.030), 0.3), material)
        assembly.add_both_sides(side.ellipse((-x + 0.01, z - 0.004), (0.075, 0.028)), SEAM)


def _add_cladding(assembly: Assembly, frame: Frame, side: Drape, look: Look) -> None:
    """Dark lips round the wheel arches, a sill strip, and mouldings along the doors."""
    lip = 0.055 if frame.shape.rugged else 0.016
    for axle in frame.axles:
        angles = np.linspace(np.pi, 0.0, 19)
        cosines, sines = np.cos(angles), np.sin(angles)
        inner = frame.arch_radius
        ring = [
            np.column_stack([-axle + radius * cosines, frame.wheel_radius + radius * sines])
            for radius in (inner * 0.985, inner + lip)
        ]
        assembly.add_both_sides(side.sheet(ring[0], ring[1], 2), PLASTIC if frame.shape.rugged else SEAM)
    if look.door_moulding:
        front, rear = (frame.x(u) for u in (_door_edges(frame)[0], _door_edges(frame)[-1]))
        height = frame.shape.clearance_m + 0.30
        moulding = side.stroke([(-front + 0.05, height), (-rear - 0.05, height)], 0.045)
        assembly.add_both_sides(moulding, PLASTIC)
    if look.chrome:
        windows = frame.shape.side_windows
        us = np.linspace(windows[0][0], windows[-1][1], 9)
        line = [(-frame.x(u), frame.belt(u) + 0.004) for u in us]
        assembly.add_both_sides(side.stroke(line, 0.016, lift_m=0.008), CHROME)


def _add_roof(assembly: Assembly, frame: Frame, look: Look) -> None:
    windows = frame.shape.side_windows
    height = frame.size[2]
    if look.roof_rails and frame.shape.hatch and len(windows) > 1:
        us = np.linspace(windows[0][1] - 0.06, windows[-1][1] - 0.02, 5)
        points = [
            (frame.x(u), frame.half_width(u) * frame.shape.roof_width * 0.94, frame.roof(u) + lift)
            for u, lift in zip(us, (-0.03, 0.012, 0.012, 0.012, -0.03), strict=True)
        ]
        rail = merge([limb(a, b, 0.018, 0.018, 5) for a, b in zip(points, points[1:], strict=False)])
        assembly.add_both_sides(rail, CHROME if look.chrome else PLASTIC)
    if look.spoiler and frame.shape.bed is None and frame.shape.rear_window:
        _add_spoiler(assembly, frame, look)
    u = 0.66 if frame.shape.bed is None else 0.55
    if look.antenna == 0:
        foot = (frame.x(u + 0.1), 0.0, frame.roof(u + 0.1))
        assembly.add(tube(foot, (foot[0] - 0.22, 0.0, foot[2] + 0.16), 0.006, 4), PLASTIC)
    elif look.antenna == 1:
        fin = ellipsoid((frame.x(u), 0.0, min(frame.roof(u), height) + 0.005), (0.10, 0.022, 0.045), 8, 5)
        assembly.add(fin, paint(look.colour))


def _add_spoiler(assembly: Assembly, frame: Frame, look: Look) -> None:
    window = frame.shape.rear_window or (0.9, 0.95)
    u = window[0] - 0.004 if frame.shape.hatch else 0.975
    width = frame.half_width(u) * (frame.shape.roof_width * 1.7 if frame.shape.hatch else 1.65)
    lip = box((frame.x(u) - 0.05, 0.0, frame.roof(u) + 0.005), (0.20, width, 0.028), 0.4)
    assembly.add(lip, paint(look.colour))
    if frame.shape.hatch:
        light = box((frame.x(u) - 0.153, 0.0, frame.roof(u) + 0.004), (0.006, 0.30, 0.016))
        assembly.add(light, TAIL_RED)


def _add_wipers(assembly: Assembly, frame: Frame, shell: Shell) -> None:
    ahead = Drape(shell.patch, 0.0)
    foot = frame.roof(frame.shape.windscreen[0])
    half = frame.size[1] / 2
    across = np.linspace(-0.80, 0.80, 13)
    cowl = [(half * a, foot + 0.012 - 0.03 * a * a) for a in across]
    assembly.add(ahead.stroke(cowl, 0.035), PLASTIC)
    for start, end in ((0.55, 0.02), (0.02, -0.52)):
        line = [(half * start, foot + 0.03), (half * end, foot + 0.075)]
        assembly.add(ahead.stroke(line, 0.018, lift_m=0.012), PLASTIC)
