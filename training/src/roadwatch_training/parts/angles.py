"""Observation angles: a vehicle's heading relative to the ray from the camera to it (docs/method.md, section 6).

At 0 we see its rear, at pi its front, at pi/2 its left side (it goes to the left), at -pi/2 its right side.
"""

from __future__ import annotations

import math

import numpy as np
import torch
from torch import Tensor

# Bin number i is centred at i * 22.5 degrees.
BINS = 16
BIN_RAD = 2 * math.pi / BINS


def wrapped(angle_rad: np.ndarray | float) -> np.ndarray | float:
    """The same angle from -pi up to pi."""
    return (angle_rad + math.pi) % (2 * math.pi) - math.pi


def observation_angle(yaw_base_rad: float, center_base_m: list[float], camera_base_m: list[float]) -> float:
    """A vehicle's yaw less the angle of the ray from the camera's position to its centre."""
    dx, dy = center_base_m[0] - camera_base_m[0], center_base_m[1] - camera_base_m[1]
    return float(wrapped(yaw_base_rad - math.atan2(dy, dx)))


def bin_shares(angles_rad: Tensor, spread_rad: float) -> Tensor:
    """What the head should say of angles (n,): (n, bins), falling off like a von Mises density."""
    centres = torch.arange(BINS) * BIN_RAD
    return torch.softmax(torch.cos(angles_rad[:, None] - centres) / spread_rad**2, dim=1)


def likely_angle(facing: np.ndarray) -> np.ndarray:
    """The most likely bin's centre of (n, bins), -pi to pi."""
    return wrapped(facing.argmax(-1) * BIN_RAD)


def mean_angle(facing: np.ndarray) -> np.ndarray:
    """The direction of the bins' mean, weighted by squared probabilities: finer than a bin, -pi to pi.

    Squared, because a second, less likely peak would pull the mean away from the first.
    """
    turned = (facing**2 * np.exp(1j * BIN_RAD * np.arange(BINS))).sum(-1)
    return np.angle(turned)


def probability_at(facing: np.ndarray, angle_rad: np.ndarray) -> np.ndarray:
    """The probability at an angle, linear between bins: (n, bins) and (n,) give (n,)."""
    at = (angle_rad / BIN_RAD) % BINS
    low = np.floor(at).astype(int)
    share = at - low
    rows = np.arange(len(facing))
    return facing[rows, low % BINS] * (1 - share) + facing[rows, (low + 1) % BINS] * share
