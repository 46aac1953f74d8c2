"""Materials of streets, buildings and plants, drawn with variety from a seed. Colours are linear RGB."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..model import Material, Surface

ASPHALT_SHADES = ((0.055, 0.056, 0.058), (0.075, 0.075, 0.076), (0.10, 0.10, 0.10), (0.135, 0.132, 0.125),
                  (0.17, 0.165, 0.155))
PAVING_SHADES = ((0.26, 0.25, 0.24), (0.32, 0.30, 0.27), (0.20, 0.20, 0.20), (0.30, 0.22, 0.18),
    (0.38, 0.36, 0.33))
WALL_SHADES = (
    (0.62, 0.58, 0.50), (0.55, 0.46, 0.34), (0.70, 0.68, 0.64), (0.45, 0.43, 0.41), (0.58, 0.40, 0.29),
    (0.66, 0.60, 0.42), (0.40, 0.45, 0.50), (0.33, 0.30, 0.28), (0.62, 0.50, 0.46), (0.50, 0.55, 0.48),
    (0.78, 0.77, 0.74), (0.24, 0.25, 0.27),
)
BRICK_SHADES = ((0.30, 0.10, 0.06), (0.24, 0.09, 0.06), (0.36, 0.18, 0.10), (0.20, 0.12, 0.09),
    (0.42, 0.30, 0.18))
ROOF_SHADES = ((0.16, 0.07, 0.05), (0.08, 0.08, 0.085), (0.22, 0.10, 0.06), (0.12, 0.11, 0.10))
FRAME_SHADES = ((0.72, 0.72, 0.70), (0.05, 0.05, 0.055), (0.16, 0.10, 0.06), (0.35, 0.36, 0.37),
    (0.06, 0.12, 0.09))
ACCENT_SHADES = ((0.50, 0.03, 0.03), (0.03, 0.12, 0.40), (0.04, 0.28, 0.10), (0.70, 0.45, 0.03),
    (0.06, 0.06, 0.07),
                 (0.45, 0.10, 0.30), (0.10, 0.35, 0.40), (0.75, 0.72, 0.68))
LEAF_SHADES = ((0.050, 0.105, 0.022), (0.035, 0.080, 0.020), (0.075, 0.125, 0.030), (0.060, 0.090, 0.035),
               (0.100, 0.120, 0.025))
AUTUMN_SHADES = ((0.22, 0.10, 0.015), (0.28, 0.17, 0.02), (0.16, 0.05, 0.015))

GLASS = Material("window glass", (0.022, 0.026, 0.030), gloss=0.92, f0=0.07)
LIT_GLASS = Material("lit window", (0.60, 0.46, 0.26), gloss=0.5, f0=0.05, emission=0.45)
CURTAIN = Material("curtained window", (0.30, 0.29, 0.27), gloss=0.6, f0=0.05)
STEEL = Material("galvanised steel", (0.34, 0.35, 0.36), gloss=0.35, f0=0.25, metallic=0.4)
DARK_STEEL = Material("painted steel", (0.035, 0.04, 0.04), gloss=0.3, f0=0.04)
WHITE_PAINT = Material("road paint", (0.66, 0.66, 0.63), gloss=0.1, f0=0.03)
YELLOW_PAINT = Material("yellow road paint", (0.62, 0.42, 0.05), gloss=0.1, f0=0.03)
CONCRETE = Material("concrete", (0.36, 0.35, 0.33), surface=Surface.PLASTER)
BARK = Material("bark", (0.075, 0.055, 0.040), surface=Surface.CLOTH)
PALE_BARK = Material("pale bark", (0.17, 0.155, 0.13), surface=Surface.PLASTER)
WOOD = Material("wood", (0.20, 0.13, 0.07), surface=Surface.CLOTH)
RUBBER = Material("black plastic", (0.02, 0.02, 0.021), gloss=0.3, f0=0.03)
RETROREFLECTIVE = Material("sign white", (0.74, 0.74, 0.73), gloss=0.25, f0=0.04)


def choice(rng: np.random.Generator, options):
    """One of the options, each as likely."""
    return options[int(rng.integers(len(options)))]


def varied(rng: np.random.Generator, colour, spread: float = 0.15) -> tuple[float, float, float]:
    """The colour, lighter or darker and a little warmer or cooler."""
    shade = rng.uniform(1.0 - spread, 1.0 + spread)
    tint = rng.uniform(1.0 - 0.3 * spread, 1.0 + 0.3 * spread, 3)
    red, green, blue = np.clip(np.asarray(colour) * shade * tint, 0.005, 0.9)
    return (round(float(red), 4), round(float(green), 4), round(float(blue), 4))


def leaves(rng: np.random.Generator, autumn_share: float = 0.12) -> Material:
    """Foliage of one plant."""
    shades = AUTUMN_SHADES if rng.random() < autumn_share else LEAF_SHADES
    return Material("leaves", varied(rng, choice(rng, shades), 0.25), gloss=0.15, f0=0.02,
        surface=Surface.FOLIAGE)


def wall(rng: np.random.Generator) -> Material:
    """A wall, of brick or rendered."""
    if rng.random() < 0.35:
        return Material("brick", varied(rng, choice(rng, BRICK_SHADES)), surface=Surface.BRICK)
    return Material("plaster", varied(rng, choice(rng, WALL_SHADES)), surface=Surface.PLASTER)


def painted(rng: np.random.Generator, shades=ACCENT_SHADES, gloss: float = 0.35) -> Material:
    """Painted metal, wood or plastic."""
    return Material("paint", varied(rng, choice(rng, shades)), gloss=gloss, f0=0.04)


@dataclass(frozen=True)
class GroundMaterials:
    """What the ground of one place is made of."""

    road: Material
    paving: Material
    kerb: Material
    grass: Material
    patch: Material


def ground_materials(rng: np.random.Generator) -> GroundMaterials:
    """Road, pavement, kerb and grass of one place."""
    road = np.array(varied(rng, choice(rng, ASPHALT_SHADES), 0.1))
    grass = varied(rng, choice(rng, ((0.075, 0.115, 0.032), (0.11, 0.12, 0.045), (0.06, 0.09, 0.025))), 0.2)
    patch = tuple(round(float(c), 4) for c in road * rng.uniform(0.7, 0.9))
    return GroundMaterials(
        road=Material("asphalt", tuple(float(c) for c in road), surface=Surface.ASPHALT),
        paving=Material("paving", varied(rng, choice(rng, PAVING_SHADES)), surface=Surface.PAVING),
        kerb=Material("kerb", varied(rng, (0.36, 0.35, 0.33)), surface=Surface.PLASTER),
        grass=Material("grass", grass, surface=Surface.GRASS),
        patch=Material("asphalt patch", patch, surface=Surface.ASPHALT),
    )
