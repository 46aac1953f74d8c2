"""Light, colour and the camera: everything about a picture but where things are.

Each function takes and gives uint8 RGB. `photometric` draws which of them happen.
"""

from __future__ import annotations

from collections.abc import Callable

import cv2
import numpy as np

Change = Callable[[np.ndarray, np.random.Generator], np.ndarray]

# Normal noise drawn once: drawing it per picture would cost more than everything else here.
_NOISE = np.random.default_rng(7).standard_normal(1 << 21).astype(np.float32)
LEVELS = np.arange(256, dtype=np.float32)


def photometric(image: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """A random selection of all changes: scene first, then lens, then sensor and transmission."""
    for probability, change in CHANGES:
        if rng.random() < probability:
            image = change(image, rng)
    return image


def tone_curves(image: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Gamma, contrast, brightness together and per channel, sometimes clipped or posterised: one table."""
    tables = np.empty((256, 3), np.float32)
    gamma = np.exp(rng.normal(0, 0.35))
    contrast = np.exp(rng.normal(0, 0.3))
    brightness = rng.normal(0, 28)
    for channel in range(3):
        own_gamma = gamma * np.exp(rng.normal(0, 0.06))
        curve = 255 * (LEVELS / 255) ** own_gamma
        curve = (curve - 128) * contrast * np.exp(rng.normal(0, 0.06)) + 128 + brightness + rng.normal(0, 6)
        tables[:, channel] = curve
    if rng.random() < 0.04:
        step = float(rng.choice((16, 32)))
        tables = np.floor(tables / step) * step
    return cv2.LUT(image, tables.clip(0, 255).astype(np.uint8)[None])


def hue_and_saturation(image: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    hsv = cv2.cvtColor(image, cv2.COLOR_RGB2HSV)
    levels = np.arange(256)
    hue = ((levels + rng.integers(-90, 90) * (rng.random() < 0.5) + rng.normal(0, 6)) % 180).astype(np.uint8)
    saturation = (levels * np.exp(rng.normal(-0.1, 0.5))).clip(0, 255).astype(np.uint8)
    table = np.stack((hue, saturation, levels.astype(np.uint8)), axis=1)[None]
    return cv2.cvtColor(cv2.LUT(hsv, table), cv2.COLOR_HSV2RGB)


def grey(image: np.ndarray, _: np.random.Generator) -> np.ndarray:
    return cv2.cvtColor(cv2.cvtColor(image, cv2.COLOR_RGB2GRAY), cv2.COLOR_GRAY2RGB)


def channel_mix(image: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Every channel a mixture of all three."""
    matrix = np.eye(3) + rng.normal(0, 0.25, (3, 3))
    matrix /= np.abs(matrix.sum(1, keepdims=True)).clip(0.3)
    return cv2.transform(image, matrix.astype(np.float32))


def random_filter(image: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """A random small filter: shapes stay, textures become others (Xu et al., "RandConv", ICLR 2021)."""
    side = int(rng.choice((3, 5)))
    kernel = rng.normal(0, 0.6 / side, (side, side))
    kernel[side // 2, side // 2] += 1.0
    kernel /= max(abs(kernel.sum()), 0.3)
    share = rng.uniform(0.3, 1.0)
    filtered = cv2.filter2D(image, -1, kernel.astype(np.float32), borderType=cv2.BORDER_REFLECT)
    return cv2.addWeighted(filtered, share, image, 1 - share, 0)


def borrowed_colours(image: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Means and spreads of the channels moved to random ones (Reinhard's colour transfer)."""
    mean, spread = (v.ravel() for v in cv2.meanStdDev(image))
    wanted_mean = rng.uniform(60, 170) + rng.normal(0, 12, 3)
    wanted_spread = rng.uniform(30, 75) * np.exp(rng.normal(0, 0.08, 3))
    gain = wanted_spread / np.maximum(spread, 8)
    table = (LEVELS[:, None] - mean) * gain + wanted_mean
    return cv2.LUT(image, table.clip(0, 255).astype(np.uint8)[None])


def amplitude_mix(image: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Amplitudes of low spatial frequencies rescaled, phases kept (Yang & Soatto, "FDA", CVPR 2020)."""
    height, width = image.shape[:2]
    small = cv2.resize(image, (width // 4, height // 4), interpolation=cv2.INTER_AREA).astype(np.float32)
    spectrum = np.fft.rfft2(small, axes=(0, 1))
    reach = int(rng.integers(2, 6))
    for rows in (slice(0, reach), slice(-reach, None)):
        factor = np.exp(rng.normal(0, 0.5, spectrum[rows, :reach].shape[:2]))[..., None]
        spectrum[rows, :reach] *= factor
    changed = np.fft.irfft2(spectrum, s=small.shape[:2], axes=(0, 1)).astype(np.float32)
    difference = cv2.resize(changed - small, (width, height), interpolation=cv2.INTER_LINEAR)
    return (image + difference).clip(0, 255).astype(np.uint8)


def uneven_light(image: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Shade and glare that vary over the picture."""
    height, width = image.shape[:2]
    coarse = rng.normal(0, 0.35, (3, 4)).astype(np.float32)
    gain = np.exp(cv2.resize(coarse, (width, height), interpolation=cv2.INTER_CUBIC))
    return cv2.multiply(image, cv2.merge((gain, gain, gain)), dtype=cv2.CV_8U)


def haze(image: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """A veil that is thickest at the horizon, in the colour of the air."""
    height = image.shape[0]
    horizon = height * rng.uniform(0.2, 0.6)
    thickness = rng.uniform(0.1, 0.6)
    distance = np.exp(-np.abs(np.arange(height) - horizon) / (height * rng.uniform(0.15, 0.6)))
    share = (thickness * distance)[:, None, None].astype(np.float32)
    air = (rng.uniform(120, 240) + rng.normal(0, 8, 3)).astype(np.float32)
    return (image + (air - image) * share).clip(0, 255).astype(np.uint8)


def out_of_focus(image: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    return cv2.GaussianBlur(image, (0, 0), float(rng.uniform(0.4, 1.6)))


def motion_blur(image: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    length = int(rng.choice((3, 5, 7)))
    kernel = np.zeros((length, length), np.float32)
    middle = length // 2
    offset = np.array([np.cos(a := rng.uniform(0, np.pi)), np.sin(a)]) * middle
    start, end = (np.round(middle + sign * offset).astype(int).tolist() for sign in (-1, 1))
    cv2.line(kernel, start, end, 1.0, 1)
    return cv2.filter2D(image, -1, kernel / kernel.sum())


def sharpened(image: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    amount = float(rng.uniform(0.3, 1.8))
    soft = cv2.GaussianBlur(image, (0, 0), float(rng.uniform(0.6, 1.6)))
    return cv2.addWeighted(image, 1 + amount, soft, -amount, 0)


def coarser(image: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """As if taken by a camera of fewer pixels."""
    height, width = image.shape[:2]
    share = rng.uniform(0.45, 0.85)
    small = cv2.resize(image, (int(width * share), int(height * share)), interpolation=cv2.INTER_AREA)
    method = cv2.INTER_CUBIC if rng.random() < 0.5 else cv2.INTER_LINEAR
    return cv2.resize(small, (width, height), interpolation=method)


def sensor_noise(image: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Normal noise, sometimes the same in all channels, sometimes in blots of two pixels."""
    height, width = image.shape[:2]
    blot = 2 if rng.random() < 0.25 else 1
    channels = 1 if rng.random() < 0.4 else 3
    shape = (-(-height // blot), -(-width // blot), channels)
    start = int(rng.integers(len(_NOISE) - np.prod(shape)))
    noise = _NOISE[start : start + np.prod(shape)].reshape(shape) * np.float32(rng.uniform(2, 16))
    if blot > 1:
        noise = cv2.resize(noise, (width, height), interpolation=cv2.INTER_LINEAR).reshape(height, width, -1)
    if channels == 1:
        noise = cv2.merge((noise,) * 3)
    return cv2.add(image, noise, dtype=cv2.CV_8U)


def jpeg(image: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    quality = int(rng.integers(25, 90))
    _, coded = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, quality])
    return cv2.imdecode(coded, cv2.IMREAD_UNCHANGED)


CHANGES: tuple[tuple[float, Change], ...] = (
    (0.20, random_filter),
    (0.15, amplitude_mix),
    (0.20, uneven_light),
    (0.35, hue_and_saturation),
    (0.20, channel_mix),
    (0.20, borrowed_colours),
    (0.15, haze),
    (0.85, tone_curves),
    (0.10, grey),
    (0.15, out_of_focus),
    (0.10, motion_blur),
    (0.20, coarser),
    (0.25, sharpened),
    (0.50, sensor_noise),
    (0.30, jpeg),
)
