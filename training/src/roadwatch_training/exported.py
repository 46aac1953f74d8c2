"""From an exported ONNX file back to a network that can be trained on.

The file holds convolutions with their normalisation folded in. They are taken over with a normalisation that
does nothing, and pictures then say what each one has to undo, so that training goes on from the same function.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np
import onnx
import torch
from onnx import numpy_helper
from torch import Tensor, nn

from .errors import TrainingError
from .network import ConvUnit, DetectorNetwork

# Of `export.DecodedNetwork`: where it keeps the network.
PREFIX = "network."


def read_exported(path: Path, network: DetectorNetwork) -> None:
    """Gives `network` the weights of an exported file; its normalisations do nothing afterwards.

    Raises TrainingError when the file is missing or holds a network of another shape.
    """
    if not path.is_file():
        raise TrainingError(f"`{path}` does not exist, nothing to start from")
    stored = {t.name: numpy_helper.to_array(t) for t in onnx.load(path).graph.initializer}
    try:
        for name, module in network.named_modules():
            if isinstance(module, ConvUnit):
                convolution, normalisation = module[0], module[1]
                _fill(convolution.weight, stored[f"{PREFIX}{name}.0.weight.half"])
                _fill(normalisation.bias, stored[f"{PREFIX}{name}.0.bias"])
                _fill(normalisation.weight, np.float32(1))
                _fill(normalisation.running_mean, np.float32(0))
                _fill(normalisation.running_var, np.float32(1 - normalisation.eps))
            elif isinstance(module, nn.Conv2d) and module.bias is not None:
                _fill(module.weight, stored[f"{PREFIX}{name}.weight.half"])
                _fill(module.bias, stored[f"{PREFIX}{name}.bias"])
    except (KeyError, ValueError) as error:
        raise TrainingError(f"`{path}` holds another network than this --width: {error}") from error


@torch.no_grad()
def settle_normalisation(network: DetectorNetwork, inputs: Iterable[Tensor]) -> None:
    """Makes every normalisation undo the means and spreads of `inputs`, without changing what comes out.

    Training normalises by its own batch; only from here does it begin with the function that was read.
    """
    seen = {module: _Moments() for module in network.modules() if isinstance(module, nn.BatchNorm2d)}
    hooks = [
        module.register_forward_pre_hook(lambda module, arguments: seen[module].add(arguments[0]))
        for module in seen
    ]
    network.eval()
    for images in inputs:
        network(images)
    for hook in hooks:
        hook.remove()
    for module, moments in seen.items():
        mean, variance = moments.mean(), moments.variance()
        module.bias += mean
        module.weight.copy_((variance + module.eps).sqrt())
        module.running_mean.copy_(mean)
        module.running_var.copy_(variance)


class _Moments:
    """First and second moments of a feature map's channels over many batches."""

    def __init__(self) -> None:
        self.batches = 0
        self.first: Tensor | float = 0.0
        self.second: Tensor | float = 0.0

    def add(self, features: Tensor) -> None:
        self.batches += 1
        self.first = self.first + features.mean((0, 2, 3), dtype=torch.float64)
        self.second = self.second + features.double().square().mean((0, 2, 3))

    def mean(self) -> Tensor:
        return self.first / self.batches

    def variance(self) -> Tensor:
        return (self.second / self.batches - self.mean().square()).clamp(min=0)


def _fill(parameter: Tensor, values: np.ndarray | np.generic) -> None:
    with torch.no_grad():
        value = torch.from_numpy(np.asarray(values, np.float32).copy())
        if value.ndim and value.shape != parameter.shape:
            raise ValueError(f"a filter is {tuple(value.shape)}, not {tuple(parameter.shape)}")
        parameter.copy_(value)
