"""A colour for each track: the same key has the same colour in every run."""

from __future__ import annotations

import hashlib
import math

Rgb = tuple[float, float, float]

HUES = 24
TONES: tuple[tuple[float, float], ...] = ((0.78, 0.13), (0.62, 0.17))
"""OKLCH lightness and chroma: hues look equally far apart and equally strong."""

COLOURS = HUES * len(TONES)


def colour_index(key: str) -> int:
    """Which of the palette's `COLOURS` a track has."""
    return int.from_bytes(hashlib.blake2b(key.encode(), digest_size=8).digest(), "big") % COLOURS


def linear_rgb(index: int) -> Rgb:
    """The palette's colour, linear RGB, 0 to 1."""
    lightness, chroma = TONES[index // HUES]
    hue = 2.0 * math.pi * (index % HUES) / HUES
    return _from_oklab(lightness, chroma * math.cos(hue), chroma * math.sin(hue))


def _from_oklab(lightness: float, a: float, b: float) -> Rgb:
    """Linear sRGB, clipped; the matrices are those of Björn Ottosson's definition of OKLab."""
    long = (lightness + 0.3963377774 * a + 0.2158037573 * b) ** 3
    medium = (lightness - 0.1055613458 * a - 0.0638541728 * b) ** 3
    short = (lightness - 0.0894841775 * a - 1.2914855480 * b) ** 3
    red = 4.0767416621 * long - 3.3077115913 * medium + 0.2309699292 * short
    green = -1.2684380046 * long + 2.6097574011 * medium - 0.3413193965 * short
    blue = -0.0041960863 * long - 0.7034186147 * medium + 1.7076147010 * short
    red, green, blue = (min(max(channel, 0.0), 1.0) for channel in (red, green, blue))
    return red, green, blue
