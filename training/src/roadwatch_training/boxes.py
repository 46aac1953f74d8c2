"""Overlaps of boxes, left, top, right, bottom."""

from __future__ import annotations

import math

import numpy as np
import torch
from torch import Tensor

EPSILON = 1e-7


def pairwise_iou(first: Tensor, second: Tensor) -> Tensor:
    """Overlap of each of (..., m, 4) with each of (..., n, 4): (..., m, n)."""
    near = torch.maximum(first[..., :, None, :2], second[..., None, :, :2])
    far = torch.minimum(first[..., :, None, 2:], second[..., None, :, 2:])
    common = (far - near).clamp(min=0).prod(-1)
    return common / (_area(first)[..., :, None] + _area(second)[..., None, :] - common + EPSILON)


def complete_iou(found: Tensor, wanted: Tensor) -> Tensor:
    """CIoU of boxes pair by pair, (n,): overlap less centre distance less difference in shape.

    Zheng et al., "Distance-IoU Loss" (AAAI 2020), equations 6 to 11.
    """
    near, far = torch.maximum(found[:, :2], wanted[:, :2]), torch.minimum(found[:, 2:], wanted[:, 2:])
    common = (far - near).clamp(min=0).prod(-1)
    iou = common / (_area(found) + _area(wanted) - common + EPSILON)
    hull = torch.maximum(found[:, 2:], wanted[:, 2:]) - torch.minimum(found[:, :2], wanted[:, :2])
    centre_offset = (found[:, :2] + found[:, 2:] - wanted[:, :2] - wanted[:, 2:]) / 2
    distance = centre_offset.square().sum(-1) / (hull.square().sum(-1) + EPSILON)
    angles = [torch.atan2(b[:, 2] - b[:, 0], b[:, 3] - b[:, 1] + EPSILON) for b in (found, wanted)]
    shape = (4 / math.pi**2) * (angles[0] - angles[1]).square()
    with torch.no_grad():
        weight = shape / (1 - iou + shape + EPSILON)
    return iou - distance - weight * shape


def _area(boxes: Tensor) -> Tensor:
    return (boxes[..., 2] - boxes[..., 0]).clamp(min=0) * (boxes[..., 3] - boxes[..., 1]).clamp(min=0)


def pairwise_iou_array(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """`pairwise_iou` of arrays."""
    return pairwise_iou(torch.from_numpy(first), torch.from_numpy(second)).numpy()
