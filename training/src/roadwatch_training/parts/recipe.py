"""From a vehicle to a training example: another box, light, lens and things in front, the same for a seed."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from ..augment.pasting import blended_with_texture
from ..augment.photometric import (
    Change,
    amplitude_mix,
    borrowed_colours,
    coarser,
    grey,
    haze,
    jpeg,
    motion_blur,
    out_of_focus,
    random_filter,
    sensor_noise,
    sharpened,
    tone_curves,
    uneven_light,
)
from ..augment.textures import texture
from .components import MIRRORED
from .crops import CropPlacement, crop, placement
from .vehicles import Vehicle

# Daemons shrink or enlarge with one of these.
INTERPOLATIONS = (cv2.INTER_LINEAR, cv2.INTER_LINEAR, cv2.INTER_AREA, cv2.INTER_CUBIC)
# Crops are never made of fewer pixels across than this.
MIN_SOURCE_WIDTH_PX = 22.0
MIN_BOX_SHARE = 0.35


@dataclass(frozen=True)
class Recipe:
    """How often each change happens, as a share of examples, and how far boxes are off."""

    # Standard deviation of a box's edge, share of its side, and how often a side is cut.
    edge_spread: float = 0.035
    cut: float = 0.12
    # Else the box is of the whole vehicle, hidden parts included.
    box_of_seen: float = 0.5
    low_resolution: float = 0.5
    covered: float = 0.3
    blended: float = 0.12
    untouched: float = 0.04


@dataclass(frozen=True)
class PartsExample:
    """`crop` uint8 (side, side, 3) RGB; `points_px` (components, 2) in it; `visible` (components,)."""

    crop: np.ndarray
    points_px: np.ndarray
    visible: np.ndarray
    angle_rad: float


def example(vehicle: Vehicle, side_px: int, recipe: Recipe, rng: np.random.Generator) -> PartsExample:
    """A random example of a vehicle; everything about it is decided by `rng`."""
    pixels, place = _framed(vehicle, side_px, recipe, rng)
    made = crop(pixels, place, side_px, int(rng.choice(INTERPOLATIONS)))
    points = place.to_crop(_scaled_points(vehicle, pixels))
    visible = vehicle.visible & _inside(points, place)
    if rng.random() >= recipe.untouched:
        made, visible = _changed(made, points, visible, place, recipe, rng)
    found = PartsExample(made, points, visible, vehicle.angle_rad)
    return mirrored(found) if rng.random() < 0.5 else found


def plain_example(vehicle: Vehicle, side_px: int) -> PartsExample | None:
    """The vehicle as an ideal detector would frame it; None when its box holds no pixel."""
    height, width = vehicle.pixels.shape[:2]
    place = placement(tuple(vehicle.seen_px), (width, height), side_px)
    if place is None:
        return None
    points = place.to_crop(vehicle.points_px)
    visible = vehicle.visible & _inside(points, place)
    return PartsExample(crop(vehicle.pixels, place, side_px), points, visible, vehicle.angle_rad)


def mirrored(made: PartsExample) -> PartsExample:
    """Left and right exchanged, of the picture and of the vehicle."""
    points = made.points_px[MIRRORED]
    points[:, 0] = made.crop.shape[1] - 1 - points[:, 0]
    pixels = np.ascontiguousarray(made.crop[:, ::-1])
    return PartsExample(pixels, points, made.visible[MIRRORED], -made.angle_rad)


def _framed(
    vehicle: Vehicle, side_px: int, recipe: Recipe, rng: np.random.Generator
) -> tuple[np.ndarray, CropPlacement]:
    """The vehicle's pixels, sometimes fewer than there were, and a detector's box in them."""
    pixels = vehicle.pixels
    box = _jittered(vehicle.seen_px if rng.random() < recipe.box_of_seen else vehicle.whole_px, recipe, rng)
    if rng.random() < recipe.low_resolution:
        across = box[2] - box[0]
        scale = float(np.exp(rng.uniform(np.log(min(MIN_SOURCE_WIDTH_PX / across, 1.0)), 0.0)))
        size = [max(round(side * scale), 2) for side in pixels.shape[1::-1]]
        scale_xy = np.array(size) / pixels.shape[1::-1]
        pixels = cv2.resize(pixels, size, interpolation=cv2.INTER_AREA)
        box = box * np.tile(scale_xy, 2)
    height, width = pixels.shape[:2]
    low = np.clip(np.floor(box[:2]), 0, [width - 2, height - 2])
    box = np.concatenate((np.minimum(box[:2], low + 1), np.maximum(box[2:], low + 2)))
    place = placement(tuple(box), (width, height), side_px)
    if place is None:
        raise ValueError(f"a box of {box} in {width}x{height} holds no pixel")
    return pixels, place


def _jittered(box: np.ndarray, recipe: Recipe, rng: np.random.Generator) -> np.ndarray:
    size = np.tile(box[2:] - box[:2], 2)
    off = rng.normal(0, recipe.edge_spread, 4).clip(-0.12, 0.12)
    if rng.random() < recipe.cut:
        edge = rng.integers(4)
        off[edge] = (1 if edge < 2 else -1) * rng.uniform(0.05, 0.4)
    moved = box + off * size
    least = (box[2:] - box[:2]) * MIN_BOX_SHARE
    return moved if (moved[2:] - moved[:2] >= least).all() else box


def _scaled_points(vehicle: Vehicle, pixels: np.ndarray) -> np.ndarray:
    scale = np.array(pixels.shape[1::-1]) / vehicle.pixels.shape[1::-1]
    return (vehicle.points_px + 0.5) * scale - 0.5


def _inside(points: np.ndarray, place: CropPlacement) -> np.ndarray:
    low = np.array([place.left_px, place.top_px]) - 0.5
    high = low + np.array([place.width_px, place.height_px])
    return ((points >= low) & (points < high)).all(1)


def _changed(
    made: np.ndarray,
    points: np.ndarray,
    visible: np.ndarray,
    place: CropPlacement,
    recipe: Recipe,
    rng: np.random.Generator,
) -> tuple[np.ndarray, np.ndarray]:
    """Everything beside geometry, within the picture; what lies beside it stays black."""
    rows = slice(place.top_px, place.top_px + place.height_px)
    columns = slice(place.left_px, place.left_px + place.width_px)
    window = made[rows, columns]
    if min(window.shape[:2]) < 8:
        return made, visible
    if rng.random() < recipe.blended:
        window = blended_with_texture(window, rng)
    if rng.random() < recipe.covered:
        window, visible = _covered(window, points - [place.left_px, place.top_px], visible, rng)
    for probability, change in CHANGES:
        if rng.random() < probability:
            window = change(window, rng)
    changed = made.copy()
    changed[rows, columns] = window
    return changed, visible


def _covered(
    window: np.ndarray, points: np.ndarray, visible: np.ndarray, rng: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """One to three patches in front; a component whose middle lies under one is not seen."""
    window, visible = window.copy(), visible.copy()
    height, width = window.shape[:2]
    for _ in range(rng.integers(1, 4)):
        size = np.maximum((rng.uniform(0.06, 0.35, 2) * [width, height]).astype(int), 4)
        low = (rng.uniform(-0.1, 1.0, 2) * [width, height]).astype(int).clip(0, [width - 4, height - 4])
        high = np.minimum(low + size, [width, height])
        flat = rng.random() < 0.4
        patch = rng.integers(0, 256, 3) if flat else texture(*(int(side) for side in high - low), rng)
        window[low[1] : high[1], low[0] : high[0]] = patch
        visible &= ~((points >= low - 0.5) & (points < high - 0.5)).all(1)
    return window, visible


def slight_hue(image: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Hue by a few degrees, saturation by a factor: red lamps stay red, white ones white."""
    hsv = cv2.cvtColor(image, cv2.COLOR_RGB2HSV)
    levels = np.arange(256)
    hue = ((levels + rng.normal(0, 4)) % 180).astype(np.uint8)
    saturation = (levels * np.exp(rng.normal(-0.15, 0.4))).clip(0, 255).astype(np.uint8)
    table = np.stack((hue, saturation, levels.astype(np.uint8)), axis=1)[None]
    return cv2.cvtColor(cv2.LUT(hsv, table), cv2.COLOR_HSV2RGB)


CHANGES: tuple[tuple[float, Change], ...] = (
    (0.15, random_filter),
    (0.15, amplitude_mix),
    (0.25, uneven_light),
    (0.40, slight_hue),
    (0.15, borrowed_colours),
    (0.15, haze),
    (0.85, tone_curves),
    (0.06, grey),
    (0.20, out_of_focus),
    (0.10, motion_blur),
    (0.20, coarser),
    (0.30, sharpened),
    (0.50, sensor_noise),
    (0.35, jpeg),
)
