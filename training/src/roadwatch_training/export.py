"""From the trained network to the ONNX file that the daemon opens.

The graph is written node by node from a trace of the module: a dozen operators are all it has, and so the
file depends on no exporter's version.
"""

from __future__ import annotations

import copy
from pathlib import Path

import numpy as np
import onnx
import torch
from onnx import TensorProto, helper, numpy_helper
from torch import fx, nn
from torch.nn import functional
from torch.nn.utils.fusion import fuse_conv_bn_eval

from .classes import CLASS_NAMES, names_metadata
from .errors import TrainingError
from .network import STRIDES, Cells, DecodedNetwork, DetectorNetwork

INPUT_SIZE_PX = (640, 384)
OPSET = 17
# The ONNX format of that operator set; older runtimes refuse newer formats.
IR_VERSION = 8
MAX_BYTES = 6_000_000
INPUT, OUTPUT, BATCH = "images", "output0", "batch"


def export(network: DetectorNetwork, path: Path, metadata: dict[str, str]) -> None:
    """Writes the network with its batch axis free and its boxes decoded; refuses a file above 6 MB."""
    width, height = INPUT_SIZE_PX
    decoded = DecodedNetwork(with_folded_normalisation(network), width, height).eval()
    model = _GraphWriter(decoded).model()
    for key, value in {"names": names_metadata(), "stride": str(STRIDES[-1]), **metadata}.items():
        entry = model.metadata_props.add()
        entry.key, entry.value = key, value
    onnx.checker.check_model(model, full_check=True)
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


class _GraphWriter:
    """Turns a traced module into an ONNX graph; knows exactly the operations of this package's networks."""

    def __init__(self, module: nn.Module) -> None:
        self.traced = fx.symbolic_trace(module)
        self.nodes: list[onnx.NodeProto] = []
        self.constants: dict[str, onnx.TensorProto] = {}
        self.values: dict[fx.Node, str] = {}

    def model(self) -> onnx.ModelProto:
        for node in self.traced.graph.nodes:
            self._write(node)
        width, height = INPUT_SIZE_PX
        cells = len(Cells.of_input(width, height).strides_px)
        shape_in, shape_out = [BATCH, 3, height, width], [BATCH, 4 + len(CLASS_NAMES), cells]
        graph = helper.make_graph(
            self.nodes,
            "roadwatch_detector",
            [helper.make_tensor_value_info(INPUT, TensorProto.FLOAT, shape_in)],
            [helper.make_tensor_value_info(OUTPUT, TensorProto.FLOAT, shape_out)],
            list(self.constants.values()),
        )
        opset = [helper.make_opsetid("", OPSET)]
        names = {"producer_name": "roadwatch-training"}
        return helper.make_model(graph, opset_imports=opset, ir_version=IR_VERSION, **names)

    def _write(self, node: fx.Node) -> None:
        if node.op == "placeholder":
            self.values[node] = INPUT
        elif node.op == "get_attr":
            self.values[node] = self._constant(node.target, _attribute(self.traced, node.target))
        elif node.op == "call_module":
            self._write_module(node, self.traced.get_submodule(node.target))
        elif node.op == "output":
            self._add("Identity", [self._value(node.args[0])], OUTPUT)
        else:
            self._write_call(node)

    def _write_module(self, node: fx.Node, module: nn.Module) -> None:
        inputs = [self._value(node.args[0])]
        if isinstance(module, nn.Conv2d):
            inputs.append(self._half_constant(f"{node.target}.weight", module.weight))
            inputs.append(self._constant(f"{node.target}.bias", module.bias))
            sides = [*module.padding, *module.padding]
            kernel, strides = list(module.kernel_size), list(module.stride)
            self._result(node, "Conv", inputs, kernel_shape=kernel, strides=strides, pads=sides)
        elif isinstance(module, nn.MaxPool2d):
            kernel, pads = [module.kernel_size] * 2, [module.padding] * 4
            self._result(node, "MaxPool", inputs, kernel_shape=kernel, strides=[module.stride] * 2, pads=pads)
        elif isinstance(module, nn.ReLU):
            self._result(node, "Relu", inputs)
        elif isinstance(module, nn.Identity):
            self.values[node] = inputs[0]
        else:
            raise NotImplementedError(f"no ONNX for the module {module}")

    def _write_call(self, node: fx.Node) -> None:
        """Functions and methods of tensors."""
        name = node.target if isinstance(node.target, str) else node.target.__name__
        if node.target is torch.cat:
            parts = [self._value(part) for part in node.args[0]]
            self._result(node, "Concat", parts, axis=node.kwargs["dim"])
        elif name in {"add", "sub", "mul"}:
            self._result(node, name.capitalize(), [self._value(argument) for argument in node.args])
        elif name in {"exp", "sigmoid"}:
            self._result(node, name.capitalize(), [self._value(node.args[0])])
        elif name == "clamp":
            most = self._constant(f"{node.name}.max", np.float32(node.kwargs["max"]))
            self._result(node, "Min", [self._value(node.args[0]), most])
        elif name == "flatten":
            shape = self._constant("flat_shape", np.array([0, 0, -1], np.int64))
            self._result(node, "Reshape", [self._value(node.args[0]), shape])
        elif name == "getitem":
            self._write_slice(node)
        elif node.target is functional.interpolate:
            scales = self._constant("doubling", np.array([1, 1, 2, 2], np.float32))
            places = {"nearest_mode": "floor", "coordinate_transformation_mode": "asymmetric"}
            self._result(node, "Resize", [self._value(node.args[0]), "", scales], mode="nearest", **places)
        else:
            raise NotImplementedError(f"no ONNX for `{name}`")

    def _write_slice(self, node: fx.Node) -> None:
        """`x[:, a:b]`."""
        channels = node.args[1][1]
        ends = np.iinfo(np.int64).max if channels.stop is None else channels.stop
        bounds = {"starts": channels.start or 0, "ends": ends, "axes": 1}
        inputs = [self._constant(f"{node.name}.{k}", np.array([v], np.int64)) for k, v in bounds.items()]
        self._result(node, "Slice", [self._value(node.args[0]), *inputs])

    def _result(self, node: fx.Node, operator: str, inputs: list[str], **attributes: object) -> None:
        self.values[node] = node.name
        self._add(operator, inputs, node.name, **attributes)

    def _add(self, operator: str, inputs: list[str], output: str, **attributes: object) -> None:
        name = f"{output}/{operator}"
        self.nodes.append(helper.make_node(operator, inputs, [output], name=name, **attributes))

    def _value(self, argument: object) -> str:
        if isinstance(argument, fx.Node):
            return self.values[argument]
        return self._constant(f"number_{argument}", np.float32(argument))

    def _half_constant(self, name: str, value: torch.Tensor) -> str:
        """Filters lie in the file with 16 bits, half its size, and are widened once when it is opened."""
        stored = self._constant(f"{name}.half", value.detach().half())
        self._add("Cast", [stored], name, to=TensorProto.FLOAT)
        return name

    def _constant(self, name: str, value: torch.Tensor | np.ndarray | np.generic) -> str:
        array = value.detach().numpy() if isinstance(value, torch.Tensor) else np.asarray(value)
        self.constants[name] = numpy_helper.from_array(np.ascontiguousarray(array).reshape(array.shape), name)
        return name


def _attribute(module: nn.Module, path: str) -> torch.Tensor:
    for name in path.split("."):
        module = getattr(module, name)
    return module
