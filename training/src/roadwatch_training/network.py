"""The detector's network: a residual backbone, a two-way feature pyramid, decoupled heads on three strides.

Plain 3x3 and 1x1 convolutions with ReLU only: on CPUs these train and run several times faster per
operation than depthwise ones, and batch normalisation folds into them on export.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import torch
from torch import Tensor, nn
from torch.nn import functional

from .classes import CLASS_NAMES

# Cell sizes of the three feature maps, pixels of the input; the daemon knows a head by these.
STRIDES = (8, 16, 32)
# An object's edges start this many cells from its cell's centre, about its size when it suits the stride.
INITIAL_REACH_CELLS = 2.0
# Share of cells that hold an object at the start; keeps the first steps from being about background only.
PRIOR_SCORE = 0.01
# Keeps the exponential finite while training is wild: 2 * e^4.2 = 133 cells, 1067 px at stride 8.
MAX_LOG_REACH = 4.2


@dataclass(frozen=True)
class NetworkShape:
    """Channels of the stem, of strides 4, 8, 16, 32, and of the pyramid; residual blocks of each stage."""

    stem: int = 16
    stages: tuple[int, int, int, int] = (32, 64, 128, 192)
    depths: tuple[int, int, int, int] = (1, 2, 2, 1)
    pyramid: int = 64


# By name: what `--width` takes. Parameters and milliseconds of each are in training/README.md.
SHAPES = {
    "small": NetworkShape(stem=12, stages=(24, 48, 96, 160), pyramid=48),
    "medium": NetworkShape(),
    "large": NetworkShape(stages=(32, 72, 144, 256), depths=(1, 2, 3, 2), pyramid=80),
}


class ConvUnit(nn.Sequential):
    """Convolution, batch normalisation, ReLU."""

    def __init__(self, inputs: int, outputs: int, kernel: int = 3, stride: int = 1) -> None:
        super().__init__(
            nn.Conv2d(inputs, outputs, kernel, stride, kernel // 2, bias=False),
            nn.BatchNorm2d(outputs),
            nn.ReLU(inplace=True),
        )


class ResidualBlock(nn.Module):
    """Two 3x3 convolutions beside an identity."""

    def __init__(self, channels: int) -> None:
        super().__init__()
        self.first = ConvUnit(channels, channels)
        self.second = ConvUnit(channels, channels)

    def forward(self, features: Tensor) -> Tensor:
        return features + self.second(self.first(features))


class SplitStage(nn.Module):
    """Cross-stage partial stage: residual blocks on one half of the channels, the other half passes by."""

    def __init__(self, inputs: int, outputs: int, depth: int) -> None:
        super().__init__()
        half = outputs // 2
        self.through = ConvUnit(inputs, half, kernel=1)
        self.past = ConvUnit(inputs, half, kernel=1)
        self.blocks = nn.Sequential(*(ResidualBlock(half) for _ in range(depth)))
        self.merge = ConvUnit(2 * half, outputs, kernel=1)

    def forward(self, features: Tensor) -> Tensor:
        return self.merge(torch.cat((self.blocks(self.through(features)), self.past(features)), dim=1))


class PoolPyramid(nn.Module):
    """Maxima over growing neighbourhoods, so that the coarsest map sees the whole of a near bus."""

    def __init__(self, channels: int) -> None:
        super().__init__()
        half = channels // 2
        self.reduce = ConvUnit(channels, half, kernel=1)
        self.pool = nn.MaxPool2d(5, stride=1, padding=2)
        self.merge = ConvUnit(4 * half, channels, kernel=1)

    def forward(self, features: Tensor) -> Tensor:
        near = self.reduce(features)
        middle = self.pool(near)
        far = self.pool(middle)
        return self.merge(torch.cat((near, middle, far, self.pool(far)), dim=1))


class Backbone(nn.Module):
    """From an image to feature maps of strides 8, 16 and 32."""

    def __init__(self, shape: NetworkShape) -> None:
        super().__init__()
        quarter, eighth, sixteenth, last = shape.stages
        self.stem = ConvUnit(3, shape.stem, stride=2)
        self.quarter = self._stage(shape.stem, quarter, shape.depths[0])
        self.eighth = self._stage(quarter, eighth, shape.depths[1])
        self.sixteenth = self._stage(eighth, sixteenth, shape.depths[2])
        self.last = nn.Sequential(self._stage(sixteenth, last, shape.depths[3]), PoolPyramid(last))

    @staticmethod
    def _stage(inputs: int, outputs: int, depth: int) -> nn.Sequential:
        return nn.Sequential(ConvUnit(inputs, outputs, stride=2), SplitStage(outputs, outputs, depth))

    def forward(self, image: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        eighth = self.eighth(self.quarter(self.stem(image)))
        sixteenth = self.sixteenth(eighth)
        return eighth, sixteenth, self.last(sixteenth)


class Pyramid(nn.Module):
    """What coarse maps know carried down to the fine ones, then what the fine ones place carried up."""

    def __init__(self, shape: NetworkShape) -> None:
        super().__init__()
        width = shape.pyramid
        _, eighth, sixteenth, last = shape.stages
        self.from_last = ConvUnit(last, width, kernel=1)
        self.from_sixteenth = ConvUnit(sixteenth, width, kernel=1)
        self.from_eighth = ConvUnit(eighth, width, kernel=1)
        self.up_sixteenth = SplitStage(2 * width, width, 1)
        self.up_eighth = SplitStage(2 * width, width, 1)
        self.down_eighth = ConvUnit(width, width, stride=2)
        self.down_sixteenth = ConvUnit(width, width, stride=2)
        self.out_sixteenth = SplitStage(2 * width, width, 1)
        self.out_last = SplitStage(2 * width, width, 1)

    def forward(self, maps: tuple[Tensor, Tensor, Tensor]) -> tuple[Tensor, Tensor, Tensor]:
        last = self.from_last(maps[2])
        sixteenth = self.up_sixteenth(torch.cat((self.from_sixteenth(maps[1]), _doubled(last)), dim=1))
        eighth = self.up_eighth(torch.cat((self.from_eighth(maps[0]), _doubled(sixteenth)), dim=1))
        sixteenth = self.out_sixteenth(torch.cat((self.down_eighth(eighth), sixteenth), dim=1))
        return eighth, sixteenth, self.out_last(torch.cat((self.down_sixteenth(sixteenth), last), dim=1))


def _doubled(features: Tensor) -> Tensor:
    return functional.interpolate(features, scale_factor=2.0, mode="nearest")


class Head(nn.Module):
    """One stride's predictions: four logarithmic reaches and a logit per class, for every cell."""

    def __init__(self, width: int, classes: int) -> None:
        super().__init__()
        self.box_tower = ConvUnit(width, width)
        self.class_tower = ConvUnit(width, width)
        self.box = nn.Conv2d(width, 4, 1)
        self.score = nn.Conv2d(width, classes, 1)
        nn.init.zeros_(self.box.weight)
        nn.init.zeros_(self.box.bias)
        nn.init.normal_(self.score.weight, std=0.01)
        nn.init.constant_(self.score.bias, -math.log((1.0 - PRIOR_SCORE) / PRIOR_SCORE))

    def forward(self, features: Tensor) -> Tensor:
        return torch.cat((self.box(self.box_tower(features)), self.score(self.class_tower(features))), dim=1)


class DetectorNetwork(nn.Module):
    """Image to raw predictions: (batch, 4 + classes, cells), cells of stride 8 first, row by row.

    The image is RGB, 0 to 1, (batch, 3, height, width), both sides multiples of 32. The first four values
    are logarithms of the distances from the cell's centre to the box's left, top, right and bottom edge, in
    units of INITIAL_REACH_CELLS cells; the others are class logits. `decode` turns them into boxes.
    """

    def __init__(self, shape: NetworkShape, classes: int = len(CLASS_NAMES)) -> None:
        super().__init__()
        self.backbone = Backbone(shape)
        self.pyramid = Pyramid(shape)
        self.heads = nn.ModuleList(Head(shape.pyramid, classes) for _ in STRIDES)

    def forward(self, image: Tensor) -> Tensor:
        maps = self.pyramid(self.backbone(image))
        return torch.cat([head(features).flatten(2) for head, features in zip(self.heads, maps)], dim=2)


@dataclass(frozen=True)
class Cells:
    """Centres (cells, 2) and strides (cells,) of all cells of an input, pixels, in the network's order."""

    centres_px: Tensor
    strides_px: Tensor

    @classmethod
    def of_input(cls, width_px: int, height_px: int) -> Cells:
        centres, strides = [], []
        for stride in STRIDES:
            rows = (torch.arange(height_px // stride) + 0.5) * stride
            columns = (torch.arange(width_px // stride) + 0.5) * stride
            y, x = torch.meshgrid(rows, columns, indexing="ij")
            centres.append(torch.stack((x, y), dim=-1).reshape(-1, 2))
            strides.append(torch.full((y.numel(),), float(stride)))
        return cls(torch.cat(centres), torch.cat(strides))

    def to(self, device: torch.device) -> Cells:
        """The same on another device."""
        return Cells(self.centres_px.to(device), self.strides_px.to(device))


def corner_boxes(raw: Tensor, cells: Cells) -> Tensor:
    """Boxes (batch, cells, 4) as left, top, right, bottom, input pixels, from the network's raw output."""
    reach = raw[:, :4].clamp(max=MAX_LOG_REACH).exp() * (INITIAL_REACH_CELLS * cells.strides_px)
    x, y = cells.centres_px.T
    left, top, right, bottom = reach.unbind(1)
    return torch.stack((x - left, y - top, x + right, y + bottom), dim=-1)


class DecodedNetwork(nn.Module):
    """What is exported: (batch, 4 + classes, cells): centre x, y, width, height in pixels, then scores."""

    def __init__(self, network: DetectorNetwork, width_px: int, height_px: int) -> None:
        super().__init__()
        self.network = network
        cells = Cells.of_input(width_px, height_px)
        self.register_buffer("centres", cells.centres_px.T[None].contiguous())
        self.register_buffer("reach_unit", (INITIAL_REACH_CELLS * cells.strides_px)[None, None])

    def forward(self, image: Tensor) -> Tensor:
        raw = self.network(image)
        reach = raw[:, :4].clamp(max=MAX_LOG_REACH).exp() * self.reach_unit
        near, far = reach[:, :2], reach[:, 2:]
        return torch.cat((self.centres + (far - near) * 0.5, near + far, raw[:, 4:].sigmoid()), dim=1)
