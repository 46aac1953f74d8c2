"""The head's network: a small pyramid over three frozen feature maps, and two outputs."""

from __future__ import annotations

import math

from torch import Tensor, nn
from torch.nn import functional

from ..network import ConvUnit
from .angles import BINS
from .components import COMPONENTS

# A heat map's cell, pixels of the crop.
CELL_PX = 8
# Channels of all maps, and values between the maps and the facing bins.
WIDTH, HIDDEN = 48, 64
DROPOUT = 0.3
# Share of cells that hold a component at the start; keeps the first steps from being about background only.
PRIOR_HEAT = 0.01


class PartsHead(nn.Module):
    """Feature maps of strides 8, 16, 32 to logits: heat (n, components, side/8, side/8), facing (n, bins).

    Facing is read off maps that learn where components are, place by place: pooled over places or read off
    the frozen maps directly, it confuses front and rear more often.
    """

    def __init__(self, channels: tuple[int, int, int], side_px: int) -> None:
        super().__init__()
        eighth, sixteenth, last = channels
        self.from_eighth = ConvUnit(eighth, WIDTH, kernel=1)
        self.from_sixteenth = ConvUnit(sixteenth, WIDTH, kernel=1)
        self.from_last = ConvUnit(last, WIDTH, kernel=1)
        self.middle = ConvUnit(WIDTH, WIDTH)
        self.fine = ConvUnit(WIDTH, WIDTH)
        self.tower = ConvUnit(WIDTH, WIDTH)
        self.heat = nn.Conv2d(WIDTH, len(COMPONENTS), 1)
        self.down_fine = ConvUnit(WIDTH, WIDTH, stride=2)
        self.down_middle = ConvUnit(WIDTH, WIDTH, stride=2)
        self.dropout = nn.Dropout(DROPOUT)
        self.hidden = nn.Linear(WIDTH * (side_px // 32) ** 2, HIDDEN)
        self.active = nn.ReLU()
        self.facing = nn.Linear(HIDDEN, BINS)
        nn.init.normal_(self.heat.weight, std=0.01)
        nn.init.constant_(self.heat.bias, -math.log((1.0 - PRIOR_HEAT) / PRIOR_HEAT))

    def forward(self, eighth: Tensor, sixteenth: Tensor, last: Tensor) -> tuple[Tensor, Tensor]:
        middle = self.middle(self.from_sixteenth(sixteenth) + _doubled(self.from_last(last)))
        fine = self.fine(self.from_eighth(eighth) + _doubled(middle))
        seen = self.dropout(self.down_middle(self.down_fine(fine) + middle).flatten(1))
        return self.heat(self.tower(fine)), self.facing(self.active(self.hidden(seen)))


class DecodedHead(nn.Module):
    """What is exported: heat after the sigmoid, facing as probabilities."""

    def __init__(self, head: PartsHead) -> None:
        super().__init__()
        self.head = head

    def forward(self, eighth: Tensor, sixteenth: Tensor, last: Tensor) -> tuple[Tensor, Tensor]:
        heat, facing = self.head(eighth, sixteenth, last)
        return heat.sigmoid(), facing.softmax(dim=1)


def _doubled(features: Tensor) -> Tensor:
    return functional.interpolate(features, scale_factor=2.0, mode="nearest")
