"""From the trained network to the ONNX file that the daemon opens."""

from __future__ import annotations

import copy
from pathlib import Path

from torch import nn
from torch.nn.utils.fusion import fuse_conv_bn_eval

from .classes import CLASS_NAMES, names_metadata
from .errors import TrainingError
from .graph import BATCH, add_metadata, written
from .network import STRIDES, Cells, DecodedNetwork, DetectorNetwork

INPUT_SIZE_PX = (640, 384)
MAX_BYTES = 6_000_000
INPUT, OUTPUT = "images", "output0"


def export(network: DetectorNetwork, path: Path, metadata: dict[str, str]) -> None:
    """Writes the network with its batch axis free and its boxes decoded; refuses a file above 6 MB."""
    width, height = INPUT_SIZE_PX
    decoded = DecodedNetwork(with_folded_normalisation(network), width, height).eval()
    cells = len(Cells.of_input(width, height).strides_px)
    outputs = {OUTPUT: [BATCH, 4 + len(CLASS_NAMES), cells]}
    model = written(decoded, "roadwatch_detector", {INPUT: [BATCH, 3, height, width]}, outputs)
    add_metadata(model, {"names": names_metadata(), "stride": str(STRIDES[-1]), **metadata})
    content = model.SerializeToString()
    if len(content) > MAX_BYTES:
        raise TrainingError(f"the model has {len(content)} bytes of {MAX_BYTES}: take a smaller --width")
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content)


def with_folded_normalisation(network: nn.Module) -> nn.Module:
    """A copy in evaluation mode whose batch normalisations are part of the convolutions before them."""
    folded = copy.deepcopy(network).float().eval()
    for module in list(folded.modules()):
        if isinstance(module, nn.Sequential) and len(module) > 1 and isinstance(module[1], nn.BatchNorm2d):
            module[0] = fuse_conv_bn_eval(module[0], module[1])
            module[1] = nn.Identity()
    return folded
