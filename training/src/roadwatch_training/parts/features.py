"""A detector's frozen features: its ONNX graph cut off before its head, run on crops of any size."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import onnx
import onnxruntime
from onnx import TensorProto, helper

from ..errors import TrainingError

# Of the three feature maps that a head reads, pixels of the crop.
FEATURE_STRIDES = (8, 16, 32)


@dataclass(frozen=True)
class InputFormat:
    """How a detector wants its pixels: `rgb` or `bgr`, and what 0 to 255 is multiplied by."""

    channels: str
    scale: float


@dataclass(frozen=True)
class FeatureSource:
    """Which tensors of which graph, of strides 8, 16 and 32, and what its input is like."""

    tensors: tuple[str, str, str]
    format: InputFormat


RGB_TO_ONE = InputFormat("rgb", 1 / 255)
# Graphs are known by the names of these tensors, those of exporters' own making.
KNOWN_SOURCES = {
    "Roadwatch's own": FeatureSource(
        (
            "network_backbone_eighth_1_merge_2",
            "network_backbone_sixteenth_1_merge_2",
            "network_backbone_last_1_merge_2",
        ),
        RGB_TO_ONE,
    ),
    "YOLOX": FeatureSource(
        (
            "/backbone/backbone/dark3/dark3.1/conv3/act/Mul_output_0",
            "/backbone/backbone/dark4/dark4.1/conv3/act/Mul_output_0",
            "/backbone/backbone/dark5/dark5.2/conv3/act/Mul_output_0",
        ),
        InputFormat("bgr", 1.0),
    ),
    "YOLOv5n v6.1": FeatureSource(("t80", "t134", "t180"), RGB_TO_ONE),
}


class FrozenFeatures:
    """Runs the part of a detector that makes the feature maps."""

    def __init__(self, path: Path, source: FeatureSource | None = None, threads: int = 1) -> None:
        """`source` None: one of KNOWN_SOURCES, whichever the graph has the tensors of."""
        if not path.is_file():
            raise TrainingError(f"`{path}` does not exist: give the detector's ONNX file")
        content = path.read_bytes()
        self.sha256 = hashlib.sha256(content).hexdigest()
        model = onnx.load_from_string(content)
        self.source = source or _known_source(path, model)
        options = onnxruntime.SessionOptions()
        options.intra_op_num_threads = threads
        cut = cut_graph(model, self.source.tensors).SerializeToString()
        self.session = onnxruntime.InferenceSession(cut, options, providers=["CPUExecutionProvider"])
        self.input_name = self.session.get_inputs()[0].name

    def of(self, crops: np.ndarray) -> list[np.ndarray]:
        """Feature maps (n, channels, side / stride, side / stride) of RGB uint8 crops (n, side, side, 3)."""
        wanted = self.source.format
        ordered = crops if wanted.channels == "rgb" else crops[..., ::-1]
        pixels = np.ascontiguousarray(ordered.transpose(0, 3, 1, 2), np.float32) * np.float32(wanted.scale)
        return self.session.run(list(self.source.tensors), {self.input_name: pixels})

    def channels(self) -> tuple[int, int, int]:
        """Of the three feature maps; refuses maps that are not of strides 8, 16 and 32."""
        side = 4 * FEATURE_STRIDES[-1]
        maps = self.of(np.zeros((1, side, side, 3), np.uint8))
        strides = tuple(side // one.shape[2] for one in maps)
        if strides != FEATURE_STRIDES:
            names = self.source.tensors
            raise TrainingError(f"the tensors {names} have strides {strides}, not {FEATURE_STRIDES}")
        first, second, third = (one.shape[1] for one in maps)
        return first, second, third


def cut_graph(model: onnx.ModelProto, tensors: tuple[str, ...]) -> onnx.ModelProto:
    """The part of a graph that makes `tensors`, for any batch and size of picture."""
    graph = model.graph
    made = {name for node in graph.node for name in node.output}
    missing = [name for name in tensors if name not in made]
    if missing:
        raise TrainingError(f"the detector's graph has no tensors {missing}: give others with --tensors")
    needed, kept = set(tensors), []
    for node in reversed(graph.node):
        if needed.intersection(node.output):
            kept.append(node)
            needed.update(node.input)
    image = helper.make_tensor_value_info(
        graph.input[0].name, TensorProto.FLOAT, ["batch", 3, "height", "width"]
    )
    cut = helper.make_graph(
        kept[::-1],
        "features",
        [image],
        [helper.make_tensor_value_info(name, TensorProto.FLOAT, None) for name in tensors],
        [constant for constant in graph.initializer if constant.name in needed],
    )
    return helper.make_model(cut, opset_imports=model.opset_import, ir_version=model.ir_version)


def _known_source(path: Path, model: onnx.ModelProto) -> FeatureSource:
    made = {name for node in model.graph.node for name in node.output}
    for source in KNOWN_SOURCES.values():
        if made.issuperset(source.tensors):
            return source
    raise TrainingError(
        f"`{path}` is none of the known detectors ({', '.join(KNOWN_SOURCES)}): give --tensors and --input"
    )
