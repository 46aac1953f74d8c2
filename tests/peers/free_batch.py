#!/usr/bin/env python3
"""Copies an ONNX model that is fixed at one image so that it takes any number of images.

usage: free_batch.py IN.onnx OUT.onnx [--check]

The first axis of every input and output becomes free, and so does the first axis of every `Reshape`
to a constant shape that starts with 1. `--check` runs the copy on three random images at once,
compares with the given model on each of them alone, prints the largest absolute difference and
fails when it is above 1e-4 of the largest output.
"""

import argparse
import sys

import numpy as np
import onnx
from onnx import numpy_helper

AXIS = "batch"
# In a Reshape's shape: as in the tensor that comes in.
AS_IT_COMES = 0
CHECKED_BATCH = 3
# Batched kernels add up in another order; anything wrong with the axis is off by far more.
TOLERANCE = 1e-4


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("given", metavar="IN.onnx")
    arguments.add_argument("copy", metavar="OUT.onnx")
    arguments.add_argument("--check", action="store_true", help="compare a batch of three with three single runs")
    options = arguments.parse_args()

    model = onnx.load(options.given)
    reshapes = free_batch(model)
    onnx.checker.check_model(model, full_check=True)
    onnx.save(model, options.copy)
    print(f"{options.copy}: free batch axis, {reshapes} reshapes changed")
    if options.check:
        check(options.given, options.copy)


def free_batch(model):
    """Frees the batch axis in place and returns how many reshapes that took."""
    graph = model.graph
    weights = {weight.name for weight in graph.initializer}
    for value in (*graph.input, *graph.output):
        if value.name not in weights:
            first = value.type.tensor_type.shape.dim[0]
            if first.dim_value > 1:
                sys.exit(f"free_batch: {value.name} is fixed at {first.dim_value}, not at 1")
            first.dim_param = AXIS
    # Shapes noted between nodes would still say 1.
    del graph.value_info[:]

    constants = constant_tensors(graph)
    freed = {}
    for node in graph.node:
        if node.op_type != "Reshape" or node.input[1] not in constants:
            continue
        shape = numpy_helper.to_array(constants[node.input[1]])
        if shape.size == 0 or shape[0] != 1:
            continue
        # A shape of its own: other nodes may share the old one for something else.
        name = node.input[1] + "_free_batch"
        freed[name] = np.concatenate(([AS_IT_COMES], shape[1:])).astype(np.int64)
        node.input[1] = name
    graph.initializer.extend(numpy_helper.from_array(shape, name) for name, shape in freed.items())
    remove_unused_weights(graph)
    return sum(node.op_type == "Reshape" and node.input[1] in freed for node in graph.node)


def constant_tensors(graph):
    """Tensors that are the same in every run, by name."""
    tensors = {tensor.name: tensor for tensor in graph.initializer}
    for node in graph.node:
        if node.op_type == "Constant" and node.attribute[0].name == "value":
            tensors[node.output[0]] = node.attribute[0].t
    return tensors


def remove_unused_weights(graph):
    """ONNX Runtime warns of each."""
    used = {name for node in graph.node for name in node.input} | {output.name for output in graph.output}
    kept = [weight for weight in graph.initializer if weight.name in used]
    del graph.initializer[:]
    graph.initializer.extend(kept)


def check(given, copy):
    """Compares a batch with single runs; ends the program when they differ."""
    # Only the check needs it.
    import onnxruntime

    single, batched = (onnxruntime.InferenceSession(path, providers=["CPUExecutionProvider"]) for path in (given, copy))
    image = single.get_inputs()[0]
    images = np.random.default_rng(0).random((CHECKED_BATCH, *image.shape[1:]), dtype=np.float32)
    # One dark, one middling, one bright: mixed-up images cannot look alike.
    images *= np.linspace(0.2, 1.0, CHECKED_BATCH, dtype=np.float32).reshape(-1, 1, 1, 1)
    together = batched.run(None, {image.name: images})
    alone = [single.run(None, {image.name: images[i : i + 1]}) for i in range(CHECKED_BATCH)]
    for output, batch in enumerate(together):
        expected = np.concatenate([run[output] for run in alone])
        if batch.shape != expected.shape:
            sys.exit(f"free_batch: a batch of {CHECKED_BATCH} gives the shape {batch.shape}, not {expected.shape}")
        worst, largest = np.abs(batch - expected).max(), np.abs(expected).max()
        print(f"{CHECKED_BATCH} at once against single runs: largest difference {worst:.2e}, output {largest:.4g}")
        if not worst <= TOLERANCE * largest:
            sys.exit("free_batch: the copy does not compute the same as the given model")


if __name__ == "__main__":
    main()
