"""Lens, sensor and compression: from a clean picture to what a camera on a vehicle delivers."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from .errors import SimulationError

# Display values are taken to linear light with this exponent: close to sRGB, and its own exact inverse.
GAMMA = 2.2


@dataclass(frozen=True)
class Imaging:
    """What the camera does to the light.

    `noise` is the deviation of the sensor's noise at mid grey, in 8-bit steps. `blur_px` is the lens's
    blur (deviation of a Gaussian). `motion_px` is the length of a smear along `motion_rad` (0 along x).
    `exposure_ev` is in stops. `white_balance` holds factors of blue, green and red. `vignette` is the
    share of light lost in the corners. `aberration` is how much larger red is drawn than green, and blue
    smaller, as a share of the distance from the middle. `jpeg_quality` is OpenCV's, 1 to 100.
    """

    noise: float = 1.5
    blur_px: float = 0.0
    motion_px: float = 0.0
    motion_rad: float = 0.0
    exposure_ev: float = 0.0
    white_balance: tuple[float, float, float] = (1.0, 1.0, 1.0)
    vignette: float = 0.0
    aberration: float = 0.0
    jpeg_quality: int = 90

    def __post_init__(self) -> None:
        amounts = {"noise": self.noise, "blur_px": self.blur_px, "motion_px": self.motion_px}
        for name, value in amounts.items():
            if not value >= 0.0:
                raise SimulationError(f"imaging.{name} is {value}; it has to be 0 or more")
        if not 0.0 <= self.vignette < 1.0:
            raise SimulationError(f"imaging.vignette is {self.vignette}; it has to be in 0 <= vignette < 1")
        if not 1 <= self.jpeg_quality <= 100:
            raise SimulationError(f"imaging.jpeg_quality is {self.jpeg_quality}; it has to be 1 to 100")


def apply(image_bgr: np.ndarray, imaging: Imaging, rng: np.random.Generator) -> np.ndarray:
    """The picture after lens and sensor, uint8 (h, w, 3); compression is `encode_jpeg`'s."""
    image = _aberrated(image_bgr, imaging.aberration)
    image = _smeared(image, imaging.motion_px, imaging.motion_rad)
    if imaging.blur_px > 0.0:
        image = cv2.GaussianBlur(image, (0, 0), imaging.blur_px)
    levels = _exposed(image, imaging)
    return _with_noise(levels, imaging.noise, rng)


def encode_jpeg(image_bgr: np.ndarray, quality: int) -> bytes:
    """The picture as a JPEG file's bytes."""
    done, data = cv2.imencode(".jpg", image_bgr, [cv2.IMWRITE_JPEG_QUALITY, int(quality)])
    if not done:
        raise SimulationError(f"OpenCV could not encode a picture of shape {image_bgr.shape} as JPEG")
    return data.tobytes()


def _aberrated(image: np.ndarray, aberration: float) -> np.ndarray:
    """Blue drawn a little smaller and red a little larger about the middle of the picture."""
    if aberration == 0.0:
        return image
    height, width = image.shape[:2]
    middle_x, middle_y = (width - 1) / 2.0, (height - 1) / 2.0
    channels = list(cv2.split(image))
    for channel, scale in ((0, 1.0 - aberration), (2, 1.0 + aberration)):
        matrix = np.array([[scale, 0.0, middle_x * (1.0 - scale)], [0.0, scale, middle_y * (1.0 - scale)]])
        channels[channel] = cv2.warpAffine(
            channels[channel],
            matrix,
            (width, height),
            flags=cv2.INTER_LINEAR,
            borderMode=cv2.BORDER_REPLICATE,
        )
    return cv2.merge(channels)


def _smeared(image: np.ndarray, length_px: float, direction_rad: float) -> np.ndarray:
    """The picture averaged along a line of the given length."""
    if length_px <= 1.0:
        return image
    half = int(np.ceil(length_px / 2.0))
    kernel = np.zeros((2 * half + 1, 2 * half + 1), dtype=np.float32)
    for along in np.linspace(-length_px / 2.0, length_px / 2.0, 8 * half + 1):
        x, y = half + along * np.cos(direction_rad), half + along * np.sin(direction_rad)
        kernel[int(round(y)), int(round(x))] += 1.0
    return cv2.filter2D(image, -1, kernel / kernel.sum(), borderType=cv2.BORDER_REPLICATE)


def _exposed(image: np.ndarray, imaging: Imaging) -> np.ndarray:
    """Display levels, float32 0 to 255, after exposure, white balance and vignette in linear light."""
    gains = np.array(imaging.white_balance, dtype=np.float32) * np.float32(2.0**imaging.exposure_ev)
    gains = gains ** np.float32(1.0 / GAMMA)
    levels = image.astype(np.float32) * gains
    if imaging.vignette > 0.0:
        levels *= _vignette(image.shape[0], image.shape[1], imaging.vignette)[:, :, None]
    return levels


def _vignette(height: int, width: int, share: float) -> np.ndarray:
    """Factors of display levels: 1 in the middle; in the corners the light falls by `share`."""
    y, x = np.mgrid[0:height, 0:width].astype(np.float32)
    x, y = (x + 0.5) / width * 2.0 - 1.0, (y + 0.5) / height * 2.0 - 1.0
    radius_squared = (x * x + y * y) / 2.0
    return ((1.0 - share * radius_squared) ** (1.0 / GAMMA)).astype(np.float32)


def _with_noise(levels: np.ndarray, noise: float, rng: np.random.Generator) -> np.ndarray:
    """Adds noise that is half the sensor's own and half the light's, which grows with brightness."""
    if noise > 0.0:
        luminance = rng.standard_normal(levels.shape[:2], dtype=np.float32)[:, :, None]
        colour = rng.standard_normal(levels.shape, dtype=np.float32)
        strength = noise * np.sqrt(0.5 + 0.5 * np.clip(levels, 0.0, 255.0) / 128.0)
        levels = levels + strength * (0.8 * luminance + 0.6 * colour)
    return np.clip(np.rint(levels), 0.0, 255.0).astype(np.uint8)
