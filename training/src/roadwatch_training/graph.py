"""From a module's trace to an ONNX graph, written node by node.

A dozen and a half operators are all that this package's networks have, and so their files depend on no
exporter's version.
"""

from __future__ import annotations

import numpy as np
import onnx
import torch
from onnx import TensorProto, helper, numpy_helper
from torch import fx, nn
from torch.nn import functional

OPSET = 17
# The ONNX format of that operator set; older runtimes refuse newer formats.
IR_VERSION = 8
BATCH = "batch"

# A tensor's name in the file and its shape; axes that are free have a name for a size.
Described = dict[str, list[int | str]]


def written(module: nn.Module, name: str, inputs: Described, outputs: Described) -> onnx.ModelProto:
    """A model that computes what `module` does in evaluation mode, checked.

    `inputs` are in the order of the module's arguments, `outputs` in that of the tuple it returns.
    """
    model = _GraphWriter(module).model(name, inputs, outputs)
    onnx.checker.check_model(model, full_check=True)
    return model


def add_metadata(model: onnx.ModelProto, entries: dict[str, str]) -> None:
    for key, value in entries.items():
        entry = model.metadata_props.add()
        entry.key, entry.value = key, value


class _GraphWriter:
    """Turns a traced module into an ONNX graph; knows exactly the operations of this package's networks."""

    def __init__(self, module: nn.Module) -> None:
        self.traced = fx.symbolic_trace(module)
        self.nodes: list[onnx.NodeProto] = []
        self.constants: dict[str, onnx.TensorProto] = {}
        self.values: dict[fx.Node, str] = {}

    def model(self, name: str, inputs: Described, outputs: Described) -> onnx.ModelProto:
        input_names = iter(inputs)
        for node in self.traced.graph.nodes:
            if node.op == "placeholder":
                self.values[node] = next(input_names)
            elif node.op == "output":
                self._write_outputs(node.args[0], list(outputs))
            else:
                self._write(node)
        graph = helper.make_graph(
            self.nodes,
            name,
            [helper.make_tensor_value_info(n, TensorProto.FLOAT, shape) for n, shape in inputs.items()],
            [helper.make_tensor_value_info(n, TensorProto.FLOAT, shape) for n, shape in outputs.items()],
            list(self.constants.values()),
        )
        opset = [helper.make_opsetid("", OPSET)]
        names = {"producer_name": "roadwatch-training"}
        return helper.make_model(graph, opset_imports=opset, ir_version=IR_VERSION, **names)

    def _write_outputs(self, results: object, names: list[str]) -> None:
        for result, name in zip(results if isinstance(results, tuple) else (results,), names, strict=True):
            self._add("Identity", [self._value(result)], name)

    def _write(self, node: fx.Node) -> None:
        if node.op == "get_attr":
            self.values[node] = self._constant(node.target, _attribute(self.traced, node.target))
        elif node.op == "call_module":
            self._write_module(node, self.traced.get_submodule(node.target))
        else:
            self._write_call(node)

    def _write_module(self, node: fx.Node, module: nn.Module) -> None:
        inputs = [self._value(node.args[0])]
        if isinstance(module, nn.Conv2d | nn.Linear):
            inputs.append(self._half_constant(f"{node.target}.weight", module.weight))
            inputs.append(self._constant(f"{node.target}.bias", module.bias))
        if isinstance(module, nn.Conv2d):
            sides = [*module.padding, *module.padding]
            kernel, strides = list(module.kernel_size), list(module.stride)
            self._result(node, "Conv", inputs, kernel_shape=kernel, strides=strides, pads=sides)
        elif isinstance(module, nn.Linear):
            self._result(node, "Gemm", inputs, transB=1)
        elif isinstance(module, nn.MaxPool2d):
            kernel, pads = [module.kernel_size] * 2, [module.padding] * 4
            self._result(node, "MaxPool", inputs, kernel_shape=kernel, strides=[module.stride] * 2, pads=pads)
        elif isinstance(module, nn.ReLU):
            self._result(node, "Relu", inputs)
        elif isinstance(module, nn.Identity | nn.Dropout):
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
        elif name == "softmax":
            self._result(node, "Softmax", [self._value(node.args[0])], axis=node.kwargs["dim"])
        elif name == "clamp":
            most = self._constant(f"{node.name}.max", np.float32(node.kwargs["max"]))
            self._result(node, "Min", [self._value(node.args[0]), most])
        elif name == "flatten":
            self._write_flatten(node, node.args[1])
        elif name == "getitem":
            self._write_slice(node)
        elif node.target is functional.interpolate:
            scales = self._constant("doubling", np.array([1, 1, 2, 2], np.float32))
            places = {"nearest_mode": "floor", "coordinate_transformation_mode": "asymmetric"}
            self._result(node, "Resize", [self._value(node.args[0]), "", scales], mode="nearest", **places)
        else:
            raise NotImplementedError(f"no ONNX for `{name}`")

    def _write_flatten(self, node: fx.Node, kept_axes: int) -> None:
        """`x.flatten(1)` or `x.flatten(2)`: that many axes stay."""
        name = "flat_shape" if kept_axes == 2 else f"flat_shape_{kept_axes}"
        shape = self._constant(name, np.array([0] * kept_axes + [-1], np.int64))
        self._result(node, "Reshape", [self._value(node.args[0]), shape])

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
