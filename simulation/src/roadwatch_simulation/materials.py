"""The materials of vehicles and people, and the colours they come in."""

from __future__ import annotations

import numpy as np

from roadwatch_simulation.model import Material, Surface

Colour = tuple[float, float, float]

CAR_PAINTS: tuple[tuple[str, float, Colour], ...] = (
    ("white", 0.25, (0.80, 0.80, 0.79)),
    ("pearl", 0.06, (0.68, 0.67, 0.63)),
    ("black", 0.17, (0.012, 0.012, 0.014)),
    ("graphite", 0.10, (0.055, 0.058, 0.063)),
    ("grey", 0.11, (0.19, 0.195, 0.20)),
    ("silver", 0.11, (0.46, 0.47, 0.48)),
    ("navy", 0.05, (0.012, 0.025, 0.085)),
    ("blue", 0.04, (0.025, 0.10, 0.34)),
    ("red", 0.04, (0.36, 0.014, 0.018)),
    ("maroon", 0.02, (0.12, 0.012, 0.016)),
    ("green", 0.015, (0.025, 0.085, 0.045)),
    ("beige", 0.015, (0.42, 0.36, 0.27)),
    ("brown", 0.01, (0.10, 0.06, 0.035)),
    ("orange", 0.01, (0.55, 0.16, 0.02)),
    ("yellow", 0.01, (0.62, 0.42, 0.03)),
)
"""Name, share of traffic and linear RGB: white, black, grey and silver are four cars in five, as on roads."""

WORK_PAINTS: tuple[Colour, ...] = (
    (0.80, 0.80, 0.79),
    (0.80, 0.80, 0.79),
    (0.74, 0.75, 0.76),
    (0.48, 0.49, 0.50),
    (0.05, 0.05, 0.055),
    (0.65, 0.42, 0.03),
    (0.42, 0.02, 0.02),
    (0.03, 0.12, 0.36),
    (0.04, 0.20, 0.09),
)
"""Vans, lorries and buses: mostly white, then the colours of fleets."""

CLOTHES: tuple[Colour, ...] = (
    (0.015, 0.015, 0.018),
    (0.02, 0.025, 0.05),
    (0.05, 0.055, 0.06),
    (0.04, 0.07, 0.15),
    (0.10, 0.14, 0.24),
    (0.16, 0.16, 0.16),
    (0.62, 0.61, 0.58),
    (0.33, 0.28, 0.20),
    (0.12, 0.08, 0.05),
    (0.34, 0.03, 0.04),
    (0.04, 0.14, 0.08),
    (0.55, 0.36, 0.06),
    (0.45, 0.16, 0.22),
    (0.12, 0.28, 0.42),
)
SHOES: tuple[Colour, ...] = (
    (0.015, 0.014, 0.014),
    (0.03, 0.025, 0.022),
    (0.10, 0.055, 0.03),
    (0.60, 0.60, 0.58),
    (0.20, 0.20, 0.21),
)
SKIN: tuple[Colour, ...] = (
    (0.62, 0.42, 0.33),
    (0.52, 0.33, 0.24),
    (0.42, 0.25, 0.16),
    (0.26, 0.14, 0.08),
    (0.13, 0.07, 0.04),
)
HAIR: tuple[Colour, ...] = (
    (0.014, 0.011, 0.010),
    (0.05, 0.028, 0.015),
    (0.012, 0.010, 0.009),
    (0.035, 0.020, 0.012),
    (0.09, 0.05, 0.025),
    (0.30, 0.20, 0.09),
    (0.35, 0.34, 0.33),
)

GLASS = Material("glass", (0.012, 0.014, 0.016), gloss=0.97, f0=0.06)
PRIVACY_GLASS = Material("privacy glass", (0.004, 0.004, 0.005), gloss=0.97, f0=0.06)
BEHIND_GLASS_DARK = Material("seat behind glass", (0.003, 0.003, 0.003), gloss=0.97, f0=0.05)
BEHIND_GLASS_PALE = Material("cabin behind glass", (0.034, 0.034, 0.035), gloss=0.97, f0=0.06)
BEHIND_GLASS_SKIN = Material("face behind glass", (0.070, 0.046, 0.036), gloss=0.97, f0=0.05)
SEEN_THROUGH = Material("street seen through", (0.085, 0.092, 0.095), gloss=0.97, f0=0.06)
PILLAR = Material("pillar", (0.006, 0.006, 0.007), gloss=0.6, f0=0.04)
PLASTIC = Material("black plastic", (0.022, 0.022, 0.024), gloss=0.25, f0=0.03)
PIANO_BLACK = Material("black gloss", (0.008, 0.008, 0.009), gloss=0.9, f0=0.05)
SEAM = Material("gap", (0.004, 0.004, 0.004), gloss=0.0, f0=0.0)
UNDERBODY = Material("underbody", (0.006, 0.006, 0.006), gloss=0.0, f0=0.01)
TYRE = Material("tyre", (0.020, 0.020, 0.021), gloss=0.08, f0=0.02)
RIM = Material("alloy", (0.50, 0.51, 0.53), gloss=0.6, f0=0.40, metallic=0.6)
DARK_RIM = Material("dark alloy", (0.04, 0.04, 0.043), gloss=0.7, f0=0.08)
HUB_CAP = Material("hub cap", (0.26, 0.265, 0.275), gloss=0.4, f0=0.08)
BRAKE = Material("brake", (0.05, 0.048, 0.045), gloss=0.2, f0=0.05)
CHROME = Material("chrome", (0.55, 0.56, 0.58), gloss=0.92, f0=0.60, metallic=0.9)
PLATE_WHITE = Material("white plate", (0.74, 0.74, 0.72), gloss=0.3, f0=0.03)
PLATE_YELLOW = Material("yellow plate", (0.72, 0.52, 0.05), gloss=0.3, f0=0.03)
PLATE_BAND = Material("plate band", (0.01, 0.05, 0.35), gloss=0.3, f0=0.03)
PLATE_INK = Material("plate ink", (0.015, 0.015, 0.02), gloss=0.2, f0=0.02)
LAMP_CLEAR = Material("lamp glass", (0.36, 0.38, 0.41), gloss=0.95, f0=0.14, metallic=0.2)
LAMP_SMOKED = Material("lamp housing", (0.06, 0.065, 0.07), gloss=0.95, f0=0.10)
LAMP_LIT = Material("headlamp", (0.95, 0.95, 0.90), gloss=0.95, f0=0.1, emission=0.6)
TAIL_RED = Material("tail lamp", (0.34, 0.008, 0.010), gloss=0.95, f0=0.06)
TAIL_BRIGHT = Material("tail lamp lens", (0.62, 0.03, 0.02), gloss=0.95, f0=0.06, emission=0.25)
AMBER = Material("indicator", (0.70, 0.22, 0.02), gloss=0.9, f0=0.06)
WHITE_TRIM = Material("white trim", (0.72, 0.72, 0.71), gloss=0.3, f0=0.03)
STEEL = Material("steel", (0.22, 0.22, 0.23), gloss=0.4, f0=0.2, metallic=0.5)
SIGN_LETTERS = Material("destination letters", (0.95, 0.55, 0.08), gloss=0.0, f0=0.0, emission=1.0)
MIRROR_GLASS = Material("mirror glass", (0.30, 0.33, 0.36), gloss=0.98, f0=0.5, metallic=0.5)


def paint(colour: Colour) -> Material:
    """Car paint: a coloured coat under clear lacquer."""
    return Material("paint", colour, gloss=0.80, f0=0.045, metallic=0.1)


def cloth(name: str, colour: Colour) -> Material:
    """Woven stuff of a colour."""
    return Material(name, colour, gloss=0.03, f0=0.02, surface=Surface.CLOTH)


def matt(name: str, colour: Colour, gloss: float = 0.1) -> Material:
    """A plain dull surface (skin, hair, leather)."""
    return Material(name, colour, gloss=gloss, f0=0.025)


def car_colour(rng: np.random.Generator) -> Colour:
    """A car's colour drawn as in real traffic, each car a shade off its neighbours."""
    shares = np.array([share for _, share, _ in CAR_PAINTS])
    base = CAR_PAINTS[int(rng.choice(len(CAR_PAINTS), p=shares / shares.sum()))][2]
    return shaded(base, rng, 0.15)


def pick(colours: tuple[Colour, ...], rng: np.random.Generator, spread: float = 0.15) -> Colour:
    """One of `colours`, a shade lighter or darker by up to `spread`."""
    return shaded(colours[int(rng.integers(len(colours)))], rng, spread)


def shaded(colour: Colour, rng: np.random.Generator, spread: float) -> Colour:
    """`colour` times a factor within 1 +- `spread`, kept below white."""
    factor = 1.0 + spread * float(rng.uniform(-1.0, 1.0))
    red, green, blue = (min(channel * factor, 0.88) for channel in colour)
    return (red, green, blue)
