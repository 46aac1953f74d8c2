"""What training makes small: wrong class scores and misplaced boxes."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor
from torch.nn import functional

from .assignment import Assignment, Targets, assign
from .boxes import complete_iou
from .network import INITIAL_REACH_CELLS, MAX_LOG_REACH, Cells, corner_boxes

OVERLAP_WEIGHT = 2.5
# The overlap has no slope where boxes are far off; the logarithmic reach always has.
REACH_WEIGHT = 0.5
# A cell outside its small object still aims at a positive distance, in units of the initial reach.
MIN_REACH = 0.02


@dataclass(frozen=True)
class Losses:
    """The sum that is minimised, and its parts for the progress line."""

    total: Tensor
    score: float
    overlap: float
    reach: float


def detection_losses(raw: Tensor, targets: Targets, cells: Cells) -> Losses:
    """`raw` is the network's output (batch, 4 + classes, cells)."""
    boxes = corner_boxes(raw, cells)
    logits = raw[:, 4:]
    found = assign(logits.detach().sigmoid(), boxes.detach(), targets, cells)
    total_aim = found.aims.sum().clamp(min=1.0)
    score = _score_loss(logits, targets, found) / total_aim
    overlap, reach = _box_losses(raw, boxes, targets, found, cells)
    overlap, reach = overlap / total_aim, reach / total_aim
    total = score + OVERLAP_WEIGHT * overlap + REACH_WEIGHT * reach
    return Losses(total, score.item(), overlap.item(), reach.item())


def _score_loss(logits: Tensor, targets: Targets, found: Assignment) -> Tensor:
    """Binary cross-entropy against aims that say how good the box is, not only that there is one."""
    classes = targets.classes.gather(1, found.objects)
    wanted = torch.zeros_like(logits).scatter_(1, classes[:, None], found.aims[:, None])
    each = functional.binary_cross_entropy_with_logits(logits, wanted, reduction="none")
    return (each * found.counted[:, None]).sum()


def _box_losses(
    raw: Tensor, boxes: Tensor, targets: Targets, found: Assignment, cells: Cells
) -> tuple[Tensor, Tensor]:
    """Overlap and reach losses of the positive cells, weighted by their aims."""
    image, cell = found.positive.nonzero(as_tuple=True)
    weight = found.aims[image, cell]
    wanted = targets.boxes_px[image, found.objects[image, cell]]
    overlap = ((1.0 - complete_iou(boxes[image, cell], wanted)) * weight).sum()
    centres = cells.centres_px[cell]
    distances = torch.cat((centres - wanted[:, :2], wanted[:, 2:] - centres), dim=1)
    unit = INITIAL_REACH_CELLS * cells.strides_px[cell, None]
    log_reach = (distances / unit).clamp(min=MIN_REACH).log().clamp(max=MAX_LOG_REACH)
    off = functional.smooth_l1_loss(raw[image, :4, cell], log_reach, reduction="none", beta=0.1)
    return overlap, (off.mean(1) * weight).sum()
