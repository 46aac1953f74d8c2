"""What training makes small: wrong heat, and wrong shares of the facing bins."""

from __future__ import annotations

import math
from dataclasses import dataclass

import torch
from torch import Tensor
from torch.nn import functional

from .angles import bin_shares
from .network import CELL_PX

FACING_WEIGHT = 0.5
# The falling off of the facing bins' shares: one bin's width, so that neighbours count as nearly right.
FACING_SPREAD_RAD = math.radians(16)


@dataclass(frozen=True)
class PartsTargets:
    """Components (batch, components, 2) px of the crop, whether seen (batch, components), angles (batch,)."""

    points_px: Tensor
    visible: Tensor
    angles_rad: Tensor


@dataclass(frozen=True)
class PartsLosses:
    """The sum that is minimised, and its parts for the progress line."""

    total: Tensor
    heat: float
    facing: float


def parts_losses(heat: Tensor, facing: Tensor, targets: PartsTargets) -> PartsLosses:
    """`heat` and `facing` are the head's logits."""
    heat_loss = _heat_loss(heat, target_heat(targets, heat.shape[-1]))
    facing_loss = _facing_loss(facing, bin_shares(targets.angles_rad, FACING_SPREAD_RAD))
    total = heat_loss + FACING_WEIGHT * facing_loss
    return PartsLosses(total, heat_loss.item(), facing_loss.item())


def target_heat(targets: PartsTargets, cells: int) -> Tensor:
    """Heat (batch, components, cells, cells): 1 at the cell nearest to a component, less at up to three more.

    Shares are those of bilinear interpolation over their largest, so that the centroid of a maximum's
    neighbourhood is the component's place exactly.
    """
    at = (targets.points_px - (CELL_PX - 1) / 2) / CELL_PX
    centres = torch.arange(cells, dtype=at.dtype)
    near = (1 - (at[..., None] - centres).abs()).clamp(min=0)
    heat = near[:, :, 1, :, None] * near[:, :, 0, None, :]
    largest = heat.amax((2, 3), keepdim=True)
    return heat / largest.clamp(min=1e-6) * targets.visible[..., None, None]


def _heat_loss(logits: Tensor, wanted: Tensor) -> Tensor:
    """Cross-entropy that cells count in by how far off they are (Li et al., "GFL", NeurIPS 2020, eq. 2)."""
    off = (logits.sigmoid() - wanted).square()
    each = functional.binary_cross_entropy_with_logits(logits, wanted, reduction="none")
    return (off * each).sum() / (wanted == 1).sum().clamp(min=1)


def _facing_loss(logits: Tensor, wanted: Tensor) -> Tensor:
    """How much is lost by the head's shares against the wanted ones; 0 when they agree."""
    return functional.kl_div(functional.log_softmax(logits, dim=1), wanted, reduction="batchmean")
