"""The human figure: joints in metres, and clothes put round them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from roadwatch_simulation.assembly import Assembly
from roadwatch_simulation.geometry import Patch, aligned, box, ellipsoid, limb, loft
from roadwatch_simulation.materials import CLOTHES, HAIR, PLASTIC, SHOES, SKIN, Colour, cloth, matt, pick
from roadwatch_simulation.model import Material

Point = np.ndarray


@dataclass(frozen=True)
class Joints:
    """A pose: points in model axes (m). Pairs are (left, right)."""

    pelvis: Point
    neck: Point
    head: Point
    shoulders: tuple[Point, Point]
    elbows: tuple[Point, Point]
    hands: tuple[Point, Point]
    hips: tuple[Point, Point]
    knees: tuple[Point, Point]
    ankles: tuple[Point, Point]
    toes: tuple[Point, Point]
    height: float
    girth: float


@dataclass(frozen=True)
class Outfit:
    """What somebody wears and carries."""

    top: Material
    bottom: Material
    shoes: Material
    skin: Material
    hair: Material
    bag: Material
    long_sleeves: bool
    skirt: bool
    shorts: bool
    coat: bool
    long_hair: bool
    hat: bool
    backpack: bool
    shoulder_bag: bool
    helmet: Material | None = None


def draw_outfit(rng: np.random.Generator, top: Colour | None = None, helmet: Colour | None = None) -> Outfit:
    """Clothes, skin and hair of one person."""
    chance = rng.random(8)
    return Outfit(
        top=cloth("top", top or pick(CLOTHES, rng)),
        bottom=cloth("bottom", pick(CLOTHES[:9], rng)),
        shoes=matt("shoes", pick(SHOES, rng)),
        skin=matt("skin", pick(SKIN, rng), 0.2),
        hair=matt("hair", pick(HAIR, rng), 0.25),
        bag=matt("bag", pick(CLOTHES, rng), 0.2),
        long_sleeves=bool(chance[0] < 0.65),
        skirt=bool(chance[1] < 0.15),
        shorts=bool(chance[2] < 0.15),
        coat=bool(chance[3] < 0.25),
        long_hair=bool(chance[4] < 0.35),
        hat=bool(chance[5] < 0.15),
        backpack=bool(chance[6] < 0.25),
        shoulder_bag=bool(chance[7] < 0.2),
        helmet=None if helmet is None else matt("helmet", helmet, 0.8),
    )


def bent(start: Point, end: Point, upper: float, lower: float, toward: Point) -> Point:
    """The joint between two bones of lengths `upper` and `lower` (m) that bends `toward` a direction."""
    span = end - start
    distance = float(np.clip(np.linalg.norm(span), 1e-3, (upper + lower) * 0.999))
    along = span / np.linalg.norm(span)
    reach = (upper**2 - lower**2 + distance**2) / (2.0 * distance)
    rise = float(np.sqrt(max(upper**2 - reach**2, 0.0)))
    aside = toward - along * float(toward @ along)
    return start + along * reach + aside / max(float(np.linalg.norm(aside)), 1e-6) * rise


def add_figure(assembly: Assembly, joints: Joints, outfit: Outfit) -> None:
    """Adds a dressed person in a pose."""
    _add_trunk(assembly, joints, outfit)
    _add_head(assembly, joints, outfit)
    for side in (0, 1):
        _add_leg(assembly, joints, outfit, side)
        _add_arm(assembly, joints, outfit, side)
    _add_luggage(assembly, joints, outfit)


def _stack(rings: list[tuple[float, float, float, float]], base: Point, direction: Point) -> Patch:
    """Ellipses (height, half depth, half width, forward shift) skinned along a direction from `base`."""
    angles = np.linspace(0.0, 2.0 * np.pi, 14, endpoint=False)
    skin = [
        np.stack(
            [depth * np.cos(angles) + shift, width * np.sin(angles), np.full_like(angles, height)], axis=1
        )
        for height, depth, width, shift in rings
    ]
    return loft(np.array(skin), smooth_below_deg=70.0).turned(aligned(direction)).moved(base)


def _add_trunk(assembly: Assembly, joints: Joints, outfit: Outfit) -> None:
    h, g = joints.height, joints.girth
    spine = joints.neck - joints.pelvis
    length = float(np.linalg.norm(spine))
    hem = -0.20 * h if outfit.coat else -0.035 * h
    flare = 1.12 if outfit.coat else 1.0
    rings = [
        (hem, 0.062 * h * g * flare, 0.094 * h * g * flare, 0.0),
        (0.0, 0.066 * h * g, 0.096 * h * g, 0.0),
        (0.35 * length, 0.060 * h * g, 0.086 * h * g, 0.004 * h),
        (0.68 * length, 0.068 * h * g, 0.106 * h * g, 0.0),
        (0.86 * length, 0.056 * h * g, 0.106 * h * g, -0.006 * h),
        (0.95 * length, 0.042 * h * g, 0.066 * h * g, -0.006 * h),
        (1.0 * length, 0.030 * h, 0.036 * h, 0.0),
    ]
    assembly.add(_stack(rings, joints.pelvis, spine), outfit.top)
    seat = ellipsoid(joints.pelvis - [0.0, 0.0, 0.015 * h], (0.064 * h * g, 0.092 * h * g, 0.062 * h), 12, 6)
    assembly.add(seat, outfit.bottom)
    if outfit.skirt and not outfit.coat:
        skirt = [(-0.24 * h, 0.105 * h, 0.115 * h, 0.0), (0.02 * h, 0.064 * h * g, 0.094 * h * g, 0.0)]
        assembly.add(_stack(skirt, joints.pelvis, np.array([0.0, 0.0, 1.0])), outfit.bottom)


def _add_head(assembly: Assembly, joints: Joints, outfit: Outfit) -> None:
    h = joints.height
    size = 0.067 * h * (1.0 + 0.25 * max(0.0, 1.55 - h))
    head = joints.head
    assembly.add(limb(joints.neck - [0.0, 0.0, 0.03 * h], head, 0.032 * h, 0.030 * h), outfit.skin)
    assembly.add(ellipsoid(head, (size * 0.80, size * 0.66, size), 14, 9), outfit.skin)
    nose = box(head + [size * 0.80, 0.0, -size * 0.10], (size * 0.2, size * 0.18, size * 0.28), 0.3)
    assembly.add(nose, outfit.skin)
    if outfit.helmet is not None:
        cover = ellipsoid(head + [-0.01, 0.0, size * 0.22], (size * 1.12, size * 0.92, size * 0.98), 14, 8)
        assembly.add(cover, outfit.helmet)
        return
    hair = ellipsoid(head + [-size * 0.26, 0.0, size * 0.20], (size * 0.76, size * 0.72, size * 0.90), 14, 8)
    assembly.add(hair, outfit.hair)
    if outfit.long_hair:
        radii = (size * 0.42, size * 0.72, size * 1.15)
        fall = ellipsoid(head + [-size * 0.52, 0.0, -size * 0.55], radii, 12, 7)
        assembly.add(fall, outfit.hair)
    if outfit.hat:
        hat = ellipsoid(head + [0.0, 0.0, size * 0.55], (size * 0.95, size * 0.80, size * 0.60), 12, 6)
        assembly.add(hat, outfit.bag)
        assembly.add(box(head + [size * 0.9, 0.0, size * 0.5], (size * 0.8, size, 0.015), 0.3), outfit.bag)


def _add_leg(assembly: Assembly, joints: Joints, outfit: Outfit, side: int) -> None:
    h, g = joints.height, joints.girth
    hip, knee, ankle, toe = (
        joints.hips[side], joints.knees[side], joints.ankles[side], joints.toes[side]
    )  # fmt: skip
    bare = outfit.shorts or (outfit.skirt and not outfit.coat)
    shin = outfit.skin if bare else outfit.bottom
    assembly.add(limb(hip, knee, 0.050 * h * g, 0.036 * h * g), outfit.bottom)
    assembly.add(limb(knee, ankle, 0.034 * h * g, 0.025 * h * (1.0 if bare else 1.25)), shin)
    sole = ankle - [0.0, 0.0, 0.022 * h]
    assembly.add(limb(sole - 0.12 * (toe - ankle), toe, 0.026 * h, 0.020 * h), outfit.shoes)


def _add_arm(assembly: Assembly, joints: Joints, outfit: Outfit, side: int) -> None:
    h, g = joints.height, joints.girth
    shoulder, elbow, hand = joints.shoulders[side], joints.elbows[side], joints.hands[side]
    assembly.add(limb(shoulder, elbow, 0.034 * h * g, 0.026 * h * g), outfit.top)
    forearm = outfit.top if outfit.long_sleeves or outfit.coat else outfit.skin
    assembly.add(limb(elbow, hand, 0.024 * h * g, 0.018 * h), forearm)
    grip = hand + (hand - elbow) * 0.14
    assembly.add(ellipsoid(grip, (0.022 * h, 0.016 * h, 0.030 * h), 8, 5), outfit.skin)


def _add_luggage(assembly: Assembly, joints: Joints, outfit: Outfit) -> None:
    h = joints.height
    spine = joints.neck - joints.pelvis
    if outfit.backpack:
        middle = joints.pelvis + spine * 0.62
        pack = box((-0.115 * h, 0.0, 0.0), (0.10 * h, 0.16 * h, 0.24 * h), 0.4)
        assembly.add(pack.turned(aligned(spine)).moved(middle), outfit.bag)
    if outfit.shoulder_bag:
        low = joints.hips[0] + np.array([-0.02 * h, 0.085 * h, 0.02 * h])
        assembly.add(box(low, (0.19 * h, 0.06 * h, 0.14 * h), 0.3), outfit.bag)
        assembly.add(limb(low, joints.shoulders[1] + np.array([0.0, 0.02, 0.03]), 0.012, 0.012, 5), PLASTIC)
