"""From a scene's Light to the colours that the shaders use."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..model import Light

SUN_NOON = np.array([1.0, 0.95, 0.87])
SUN_DUSK = np.array([1.0, 0.56, 0.28])
ZENITH_NOON = np.array([0.19, 0.38, 0.78])
ZENITH_DUSK = np.array([0.17, 0.22, 0.40])
ZENITH_GREY = np.array([0.60, 0.63, 0.68])
HORIZON_NOON = np.array([0.74, 0.82, 0.90])
HORIZON_DUSK = np.array([0.92, 0.63, 0.42])
HORIZON_GREY = np.array([0.70, 0.73, 0.77])
# Light thrown back by streets, and what stands along the horizon in mirrored surroundings.
GROUND_ALBEDO = np.array([0.15, 0.145, 0.135])
BAND_ALBEDO = np.array([0.16, 0.15, 0.135])
# From this strength on the sun stands in a clear sky; below, clouds close over it.
CLEAR_SUN = 1.4
# A clear sky's light is raised by what bright walls and clouds throw back into the shade.
AMBIENT_GAIN_CLEAR = 1.35
# That share of it has lost the sky's blue on the way.
AMBIENT_GREY_SHARE = 0.35
# A noon street (sun 2.6, sky 1) is exposed so; darker scenes are brightened only in part, as a camera would.
NOON_EXPOSURE = 0.60
NOON_LUMINANCE = 2.2
EXPOSURE_EXPONENT = 0.78
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
# Emission of lamps, which models give for a lamp looked at by day, when they are switched on at dusk.
LAMP_GAIN = 3.0
CLOUD_SEED = 77_003


@dataclass(frozen=True)
class Lighting:
    """Colours are linear RGB radiance; `sun_direction` is a unit vector to the sun."""

    sun_direction: np.ndarray
    sun_colour: np.ndarray
    uniforms: dict[str, object]

    @property
    def is_wet(self) -> bool:
        """True when the ground mirrors."""
        return bool(self.uniforms["wetness"])

    @property
    def lamps_on(self) -> bool:
        """True when lamps of vehicles shine."""
        return bool(self.uniforms["lamps"])

    @property
    def is_sunny(self) -> bool:
        """True when the sun throws shadows."""
        return bool(self.sun_colour.max() > 0.0)


def _mixed(first, second, share: float):
    return first + (second - first) * share


def _clouds(light: Light, grey: float) -> tuple[float, tuple[float, float]]:
    rng = np.random.default_rng([CLOUD_SEED, light.seed])
    cover = _mixed(np.array(rng.uniform(0.15, 0.75)), np.array(1.05), grey)
    offset = rng.uniform(0.0, 1.0, size=2)
    return float(cover), (float(offset[0]), float(offset[1]))


def lighting_of(light: Light) -> Lighting:
    """The colours of sun, sky, ground and surroundings, and the exposure for them."""
    direction = np.asarray(light.sun_direction, dtype=float)
    direction = direction / np.linalg.norm(direction)
    grey = float(np.clip(1.0 - light.sun / CLEAR_SUN, 0.0, 1.0))
    above = float(np.clip((direction[2] + 0.01) / 0.06, 0.0, 1.0))
    sun = _mixed(SUN_NOON, SUN_DUSK, light.warmth) * light.sun * above
    zenith = _mixed(_mixed(ZENITH_NOON, ZENITH_DUSK, light.warmth), ZENITH_GREY, grey) * light.sky
    horizon = _mixed(_mixed(HORIZON_NOON, HORIZON_DUSK, light.warmth), HORIZON_GREY, grey) * light.sky
    ambient = (0.60 * zenith + 0.40 * horizon) * _mixed(AMBIENT_GAIN_CLEAR, 1.0, grey)
    ambient = _mixed(ambient, np.full(3, ambient @ LUMINANCE), AMBIENT_GREY_SHARE)
    on_ground = ambient + sun * max(direction[2], 0.0)
    cover, offset = _clouds(light, grey)
    luminance = float(on_ground @ LUMINANCE) + 1e-3
    uniforms = {
        "sun_direction": tuple(direction),
        "sun_colour": tuple(sun),
        "zenith_colour": tuple(zenith),
        "horizon_colour": tuple(horizon),
        "cloud_colour": tuple(0.92 * horizon + 0.10 * sun),
        "ground_colour": tuple(GROUND_ALBEDO * on_ground * 0.8),
        "band_colour": tuple(BAND_ALBEDO * (ambient + 0.35 * sun)),
        "ambient_up": tuple(ambient),
        "ambient_down": tuple(GROUND_ALBEDO * on_ground + 0.06 * ambient),
        "cloud_cover": cover,
        "cloud_offset": offset,
        "exposure": NOON_EXPOSURE * (NOON_LUMINANCE / luminance) ** EXPOSURE_EXPONENT,
        "haze_per_m": light.haze_per_m,
        "wetness": light.wetness,
        "lamps": LAMP_GAIN if light.headlights else 0.0,
    }
    return Lighting(direction, sun, uniforms)
