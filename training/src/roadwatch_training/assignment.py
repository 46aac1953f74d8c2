"""Which cells answer for which object: task-aligned assignment.

After Feng et al., "TOOD" (ICCV 2021), section 3.2: a cell is as good as its score for the object's class
times its box's overlap with it, each to a power; each object takes its best cells.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from .boxes import pairwise_iou
from .network import Cells

CELLS_PER_OBJECT = 10
SCORE_POWER = 0.5
OVERLAP_POWER = 6.0
# A cell may answer for an object when its centre is in the box, or this near the box's centre, pixels:
# a box of 8 px can lie between the cell centres of stride 8.
NEAR_CENTRE_PX = 4.8
EPSILON = 1e-9


@dataclass(frozen=True)
class Targets:
    """Objects of a batch, padded: boxes (batch, most, 4) px; classes, sought, ignored (batch, most)."""

    boxes_px: Tensor
    classes: Tensor
    sought: Tensor
    ignored: Tensor

    def to(self, device: torch.device) -> Targets:
        """The same on another device."""
        return Targets(*(part.to(device) for part in (self.boxes_px, self.classes, self.sought, self.ignored)))


@dataclass(frozen=True)
class Assignment:
    """For every cell, (batch, cells): whether it is positive, its object, its aim for the object's class.

    `counted` is false where the class loss leaves a cell alone: inside objects that are not sought.
    """

    positive: Tensor
    objects: Tensor
    aims: Tensor
    counted: Tensor


@torch.no_grad()
def assign(scores: Tensor, boxes_px: Tensor, targets: Targets, cells: Cells) -> Assignment:
    """`scores` (batch, classes, cells) after the sigmoid, `boxes_px` (batch, cells, 4)."""
    within = _cells_within(targets.boxes_px, cells)
    candidates = within & targets.sought[..., None]
    overlaps = pairwise_iou(targets.boxes_px, boxes_px) * candidates
    classes = targets.classes[..., None].expand(-1, -1, scores.shape[2])
    alignment = scores.gather(1, classes).pow(SCORE_POWER) * overlaps.pow(OVERLAP_POWER)
    alignment = torch.where(candidates, alignment + EPSILON, torch.zeros_like(alignment))
    chosen = _best_cells(alignment)
    # A cell wanted by several objects answers for the one it overlaps most.
    claimed = torch.where(chosen, overlaps + EPSILON, torch.zeros_like(overlaps))
    objects = claimed.argmax(1)
    mine = torch.zeros_like(chosen).scatter_(1, objects[:, None], 1) & chosen
    positive = mine.any(1)
    aims = _aims(alignment * mine, overlaps * mine)
    in_ignored = (within & targets.ignored[..., None]).any(1)
    return Assignment(positive, objects, aims, positive | ~in_ignored)


def _cells_within(boxes_px: Tensor, cells: Cells) -> Tensor:
    """(batch, objects, cells): whether a cell's centre is in the box, or near the box's centre."""
    centre = (boxes_px[..., :2] + boxes_px[..., 2:]) / 2
    half_size = ((boxes_px[..., 2:] - boxes_px[..., :2]) / 2).clamp(min=NEAR_CENTRE_PX)
    offset = (cells.centres_px - centre[..., None, :]).abs()
    return (offset < half_size[..., None, :]).all(-1)


def _best_cells(alignment: Tensor) -> Tensor:
    count = min(CELLS_PER_OBJECT, alignment.shape[2])
    best = alignment.topk(count, dim=2)
    return torch.zeros_like(alignment, dtype=torch.bool).scatter_(2, best.indices, best.values > 0)


def _aims(alignment: Tensor, overlaps: Tensor) -> Tensor:
    """An object's best cell aims at the best overlap any of its cells has, the others in proportion."""
    best_alignment = alignment.amax(2, keepdim=True)
    best_overlap = overlaps.amax(2, keepdim=True)
    return (alignment / (best_alignment + EPSILON) * best_overlap).amax(1)
