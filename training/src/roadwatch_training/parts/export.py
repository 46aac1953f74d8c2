"""From the trained head to the ONNX file that the daemon opens beside the detector's."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

from ..errors import TrainingError
from ..export import with_folded_normalisation
from ..graph import BATCH, add_metadata, written
from .angles import BINS
from .components import COMPONENTS
from .features import FEATURE_STRIDES, FrozenFeatures
from .network import CELL_PX, DecodedHead, PartsHead

MAX_BYTES = 3_000_000
HEAT, FACING = "heat", "facing"


@dataclass(frozen=True)
class HeadNotes:
    """What the file says of itself: from which scores on components count, and how it was trained."""

    thresholds: tuple[float, ...]
    training: str


def export(head: PartsHead, features: FrozenFeatures, side_px: int, path: Path, notes: HeadNotes) -> None:
    """Writes the head with its batch axis free; refuses a file above 3 MB."""
    sides = [side_px // stride for stride in FEATURE_STRIDES]
    named = zip(features.source.tensors, features.channels(), sides)
    inputs = {tensor: [BATCH, channels, side, side] for tensor, channels, side in named}
    cells = side_px // CELL_PX
    outputs = {HEAT: [BATCH, len(COMPONENTS), cells, cells], FACING: [BATCH, BINS]}
    decoded = DecodedHead(with_folded_normalisation(head)).eval()
    model = written(decoded, "roadwatch_parts", inputs, outputs)
    add_metadata(model, _metadata(features, side_px, notes))
    content = model.SerializeToString()
    if len(content) > MAX_BYTES:
        raise TrainingError(f"the head has {len(content)} bytes of {MAX_BYTES}")
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content)


def _metadata(features: FrozenFeatures, side_px: int, notes: HeadNotes) -> dict[str, str]:
    """Lists are JSON."""
    return {
        "components": json.dumps(COMPONENTS),
        "component_thresholds": json.dumps(notes.thresholds),
        "crop_side_px": str(side_px),
        "cell_px": str(CELL_PX),
        "feature_tensors": json.dumps(features.source.tensors),
        "feature_strides": json.dumps(FEATURE_STRIDES),
        "detector_sha256": features.sha256,
        "detector_channels": features.source.format.channels,
        "detector_scale": repr(features.source.format.scale),
        "author": "Roadwatch",
        "training": notes.training,
    }
