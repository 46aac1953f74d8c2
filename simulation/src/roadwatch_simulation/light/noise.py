"""The noise texture that all procedural surfaces read, and its random numbers."""

from __future__ import annotations

from functools import cache

import numpy as np

NOISE_SIZE_PX = 512
NOISE_SEED = 20_261
# Power falls with this exponent of the frequency: 1 looks like clouds and stains, 0 is grain.
CLOUD_EXPONENT = 1.35
BLOTCH_EXPONENT = 0.9


def _spectral(rng: np.random.Generator, exponent: float) -> np.ndarray:
    """Noise that tiles, with power falling over frequency, spread evenly over 0 to 1."""
    frequency = np.fft.fftfreq(NOISE_SIZE_PX)
    radius = np.hypot(frequency[:, None], frequency[None, :])
    radius[0, 0] = 1.0
    spectrum = np.fft.fft2(rng.standard_normal((NOISE_SIZE_PX, NOISE_SIZE_PX))) / radius**exponent
    spectrum[0, 0] = 0.0
    values = np.fft.ifft2(spectrum).real
    ranks = np.argsort(np.argsort(values, axis=None))
    return ranks.reshape(values.shape) / (values.size - 1.0)


def _cracks(rng: np.random.Generator) -> np.ndarray:
    """Thin lines where a noise field crosses its middle: cracks in asphalt, veins of plaster."""
    field = _spectral(rng, CLOUD_EXPONENT)
    slope = np.hypot(*np.gradient(field)) + 1e-4
    distance_px = np.abs(field - 0.5) / slope
    return np.clip(distance_px / 2.5, 0.0, 1.0)


@cache
def noise_pixels() -> bytes:
    """RGBA8 of NOISE_SIZE_PX squared: clouds, grain, cracks (0 on a crack), blotches."""
    rng = np.random.default_rng(NOISE_SEED)
    grain = rng.random((NOISE_SIZE_PX, NOISE_SIZE_PX))
    layers = [_spectral(rng, CLOUD_EXPONENT), grain, _cracks(rng), _spectral(rng, BLOTCH_EXPONENT)]
    return (np.stack(layers, axis=-1) * 255.0 + 0.5).astype(np.uint8).tobytes()
