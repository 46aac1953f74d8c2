"""Pedestrians in mid-walk, cyclists and motorcyclists."""

from __future__ import annotations

import numpy as np

from roadwatch_simulation.assembly import Assembly, Size
from roadwatch_simulation.cycles import add_bicycle, add_motorcycle
from roadwatch_simulation.figure import Joints, Outfit, add_figure, bent, draw_outfit
from roadwatch_simulation.materials import CAR_PAINTS, Colour, pick
from roadwatch_simulation.model import Model

CHILD_SHARE = 0.15
STANDING_SHARE = 0.15
BRIGHT: tuple[Colour, ...] = tuple(colour for _, _, colour in CAR_PAINTS)


def build_pedestrian(seed: int, size: Size | None, colour: Colour | None) -> Model:
    """Somebody walking or standing; `colour` is that of the coat or shirt."""
    rng = np.random.default_rng([seed, 201])
    child = bool(rng.random() < CHILD_SHARE)
    height = float(rng.uniform(1.05, 1.45)) if child else float(np.clip(rng.normal(1.71, 0.09), 1.50, 1.96))
    stride = 0.0 if rng.random() < STANDING_SHARE else float(rng.uniform(0.75, 1.15))
    joints = _walking(height, float(rng.uniform(0.9, 1.18)), float(rng.uniform(0, 2 * np.pi)), stride, rng)
    assembly = Assembly()
    add_figure(assembly, joints, draw_outfit(rng, colour))
    return assembly.finish("pedestrian", "person", size)


def build_cyclist(seed: int, size: Size | None, colour: Colour | None) -> Model:
    """A bicycle with its rider; `colour` is the frame's."""
    rng = np.random.default_rng([seed, 202])
    assembly = Assembly()
    phase = float(rng.uniform(0, 2 * np.pi))
    seat = add_bicycle(assembly, colour or pick(BRIGHT, rng), phase, rng)
    helmet = pick(BRIGHT, rng) if rng.random() < 0.6 else None
    height = float(rng.uniform(1.62, 1.88))
    joints = _riding(height, seat, float(rng.uniform(0.32, 0.72)))
    add_figure(assembly, joints, _riders(draw_outfit(rng, None, helmet)))
    return assembly.finish("cyclist", "bicycle", size)


def build_motorcyclist(seed: int, size: Size | None, colour: Colour | None) -> Model:
    """A motorcycle with its rider; `colour` is that of the tank."""
    rng = np.random.default_rng([seed, 203])
    assembly = Assembly()
    seat = add_motorcycle(assembly, colour or pick(BRIGHT, rng), rng)
    outfit = draw_outfit(rng, None, pick(BRIGHT, rng))
    joints = _riding(float(rng.uniform(1.65, 1.88)), seat, float(rng.uniform(0.12, 0.5)))
    add_figure(assembly, joints, _riders(outfit))
    return assembly.finish("motorcyclist", "motorcycle", size)


def _riders(outfit: Outfit) -> Outfit:
    """Clothes that one can ride in."""
    kept = {name: getattr(outfit, name) for name in outfit.__dataclass_fields__}
    return Outfit(**{**kept, "skirt": False, "coat": False, "shoulder_bag": False})


def _walking(height: float, girth: float, phase: float, stride: float, rng: np.random.Generator) -> Joints:
    """A walker's pose: `phase` is where in the two steps (rad), `stride` scales the swing, 0 stands still."""
    h = height
    swing = 0.42 * stride
    pelvis = np.array([0.0, 0.0, 0.53 * h])
    lean = 0.05 * stride
    neck = pelvis + np.array([np.sin(lean), 0.0, np.cos(lean)]) * 0.315 * h
    legs = [_leg(h, side, phase + (0.0 if side > 0 else np.pi), swing) for side in (1.0, -1.0)]
    arms = [_arm(h, girth, neck, side, phase + (np.pi if side > 0 else 0.0), swing) for side in (1.0, -1.0)]
    if rng.random() < 0.15:
        arms[1] = _phone(h, girth, neck)
    head = neck + np.array([0.012 * h, 0.0, 0.092 * h])
    hips, knees, ankles, toes = zip(*legs, strict=True)
    shoulders, elbows, hands = zip(*arms, strict=True)
    return Joints(pelvis, neck, head, shoulders, elbows, hands, hips, knees, ankles, toes, h, girth)


def _leg(h: float, side: float, phase: float, swing: float) -> tuple[np.ndarray, ...]:
    hip = np.array([0.0, side * 0.050 * h, 0.52 * h])
    forward = swing * np.sin(phase)
    flex = 0.06 + 1.25 * swing * max(0.0, np.cos(phase)) ** 2
    knee = hip + 0.245 * h * np.array([np.sin(forward), 0.0, -np.cos(forward)])
    shin = forward - flex
    ankle = knee + 0.235 * h * np.array([np.sin(shin), 0.0, -np.cos(shin)])
    pitch = -0.45 * max(0.0, -np.sin(phase)) * swing * 2.0 + 0.25 * max(0.0, np.sin(phase)) * swing
    toe = ankle + 0.105 * h * np.array([np.cos(pitch), 0.0, np.sin(pitch)]) - np.array([0.0, 0.0, 0.024 * h])
    return hip, knee, ankle, toe


def _arm(
    h: float, girth: float, neck: np.ndarray, side: float, phase: float, swing: float
) -> tuple[np.ndarray, ...]:
    shoulder = neck + np.array([0.0, side * 0.101 * h * girth, -0.052 * h])
    forward = 0.85 * swing * np.sin(phase)
    out = side * 0.12
    elbow = shoulder + 0.175 * h * np.array([np.sin(forward), out, -np.cos(forward)])
    lower = forward + 0.28 + 0.4 * max(0.0, np.sin(phase)) * swing
    hand = elbow + 0.150 * h * np.array([np.sin(lower), 0.2 * out, -np.cos(lower)])
    return shoulder, elbow, hand


def _phone(h: float, girth: float, neck: np.ndarray) -> tuple[np.ndarray, ...]:
    """A right arm that holds something up in front of the face."""
    shoulder = neck + np.array([0.0, -0.101 * h * girth, -0.052 * h])
    elbow = shoulder + 0.175 * h * np.array([0.25, -0.15, -0.95])
    hand = elbow + 0.150 * h * np.array([0.75, 0.25, 0.60])
    return shoulder, elbow, hand


def _riding(height: float, seat: dict[str, np.ndarray], lean: float) -> Joints:
    """A rider on a seat: `seat` gives `saddle`, and pairs `grip_left`, `pedal_left`, ... in model axes."""
    h = height
    pelvis = seat["saddle"] + np.array([0.0, 0.0, 0.060 * h])
    neck = pelvis + np.array([np.sin(lean), 0.0, np.cos(lean)]) * 0.305 * h
    head = neck + np.array([0.030 * h, 0.0, 0.086 * h])
    sides = ((1.0, "left"), (-1.0, "right"))
    hips = tuple(pelvis + np.array([0.0, side * 0.048 * h, -0.02 * h]) for side, _ in sides)
    ankles = tuple(seat[f"pedal_{name}"] + np.array([-0.055 * h, 0.0, 0.05 * h]) for _, name in sides)
    outward = [np.array([1.0, side * 0.12, 0.35]) for side, _ in sides]
    knees = tuple(
        bent(hip, ankle, 0.245 * h, 0.245 * h, way)
        for hip, ankle, way in zip(hips, ankles, outward, strict=True)
    )
    toes = tuple(ankle + np.array([0.105 * h, 0.0, -0.035 * h]) for ankle in ankles)
    shoulders = tuple(neck + np.array([0.01 * h, side * 0.101 * h, -0.045 * h]) for side, _ in sides)
    hands = tuple(seat[f"grip_{name}"] for _, name in sides)
    droop = [np.array([-0.2, side * 0.5, -1.0]) for side, _ in sides]
    elbows = tuple(
        bent(shoulder, hand, 0.175 * h, 0.165 * h, way)
        for shoulder, hand, way in zip(shoulders, hands, droop, strict=True)
    )
    return Joints(pelvis, neck, head, shoulders, elbows, hands, hips, knees, ankles, toes, h, 1.0)
