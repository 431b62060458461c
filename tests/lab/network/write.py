"""Writes the networks of this folder that others could have written, and prints what onnxruntime gives for them.

usage: python3 tests/lab/network/write.py; needs the packages onnx, onnxruntime and numpy.
"""

from pathlib import Path

import numpy as np
import onnx
import onnxruntime
from onnx import TensorProto, helper, numpy_helper

FOLDER = Path(__file__).parent
CHANNELS = np.array([[-1.0, -0.75, -0.5, -0.25, 0.0, 0.25, 0.5, 0.75, 1.0]], np.float32)
RANDOM = np.random.default_rng(6)


def tensor(name, *sides):
    """Weights as a layer has them at first."""
    return numpy_helper.from_array(RANDOM.uniform(-0.6, 0.6, sides).astype(np.float32), name)


def row(name, *numbers):
    return numpy_helper.from_array(np.array(numbers, np.float32), name)


def constant(name, numbers):
    value = numpy_helper.from_array(np.array(numbers, np.float32), "")
    return helper.make_node("Constant", [], [name], value=value)


def write(name, nodes, tensors, ends, opset):
    """A model with a batch of any size; `ends` names what goes in and what comes out."""
    given, gives = (
        helper.make_tensor_value_info(end, TensorProto.FLOAT, ["batch", width]) for end, width in zip(ends, (9, 5))
    )
    graph = helper.make_graph(nodes, "main_graph", [given], [gives], tensors)
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", opset)], producer_name="pytorch")
    model.ir_version = 8
    onnx.checker.check_model(model, full_check=True)
    path = FOLDER / name
    onnx.save(model, path)
    session = onnxruntime.InferenceSession(path, providers=["CPUExecutionProvider"])
    contact = session.run(None, {ends[0]: CHANNELS})[0][0]
    print(f"{name}: {', '.join(f'{number:.7g}' for number in contact)}")


def traced():
    """As the exporter by tracing does it: scalers as buffers, equal biases named twice, a scale that is one number."""
    nodes = [
        constant("/Constant_output_0", 2.0),
        helper.make_node("Identity", ["1.bias"], ["3.bias"]),
        helper.make_node("Sub", ["onnx::Sub_0", "mean"], ["/Sub_output_0"]),
        helper.make_node("Div", ["/Sub_output_0", "/Constant_output_0"], ["/Div_output_0"]),
        helper.make_node("Gemm", ["/Div_output_0", "1.weight", "1.bias"], ["/1/Gemm_output_0"], transB=1, alpha=1.0),
        helper.make_node("Relu", ["/1/Gemm_output_0"], ["/2/Relu_output_0"]),
        helper.make_node("Gemm", ["/2/Relu_output_0", "3.weight", "3.bias"], ["/3/Gemm_output_0"], transB=1, beta=1.0),
        helper.make_node("Relu", ["/3/Gemm_output_0"], ["/4/Relu_output_0"]),
        helper.make_node("Gemm", ["/4/Relu_output_0", "5.weight", "5.bias"], ["/5/Gemm_output_0"], transB=1),
        helper.make_node("Mul", ["/5/Gemm_output_0", "scale"], ["/Mul_output_0"]),
        helper.make_node("Add", ["/Mul_output_0", "shift"], ["19"]),
    ]
    tensors = [
        row("mean", *(0.1 * k for k in range(9))),
        tensor("1.weight", 6, 9),
        tensor("1.bias", 6),
        tensor("3.weight", 6, 6),
        tensor("5.weight", 5, 6),
        tensor("5.bias", 5),
        row("scale", 8.0, 8.0, 0.5, 0.5, 1.5),
        row("shift", 0.0, 0.25, 0.0, 0.0, 2.0),
    ]
    write("traced.onnx", nodes, tensors, ("onnx::Sub_0", "19"), 17)


def translated():
    """As the exporter by translation does it where it does not fuse: weights turned by a step, a factor in place of a
    divisor, the other way round."""
    nodes = [
        helper.make_node("Cast", ["x"], ["_to_copy"], to=TensorProto.FLOAT),
        helper.make_node("Mul", ["inverse", "_to_copy"], ["mul"]),
        helper.make_node("Add", ["mul", "offset"], ["add"]),
        helper.make_node("Transpose", ["net.0.weight"], ["t"], perm=[1, 0]),
        helper.make_node("MatMul", ["add", "t"], ["mm"]),
        helper.make_node("Add", ["mm", "net.0.bias"], ["linear"]),
        helper.make_node("Relu", ["linear"], ["relu"]),
        helper.make_node("Gemm", ["relu", "net.2.weight", "net.2.bias"], ["linear_1"], transB=1),
        helper.make_node("Sub", ["linear_1", "back"], ["sub"]),
        helper.make_node("Div", ["sub", "divisor"], ["out"]),
    ]
    tensors = [
        row("inverse", *(1.0 + 0.25 * k for k in range(9))),
        row("offset", 0.5),
        tensor("net.0.weight", 6, 9),
        tensor("net.0.bias", 6),
        tensor("net.2.weight", 5, 6),
        tensor("net.2.bias", 5),
        row("back", 1.0, -1.0, 0.5, 0.25, -2.0),
        numpy_helper.from_array(np.float32(0.125), "divisor"),
    ]
    write("translated.onnx", nodes, tensors, ("x", "out"), 18)


def residual():
    """No chain: a block whose input is added to what it gives, other neurons, and a reshaped end."""
    nodes = [
        helper.make_node("Gemm", ["x", "a.weight", "a.bias"], ["a"], transB=1),
        helper.make_node("Tanh", ["a"], ["tanh"]),
        helper.make_node("Gemm", ["tanh", "b.weight", "b.bias"], ["b"], transB=1),
        helper.make_node("Sigmoid", ["b"], ["sigmoid"]),
        helper.make_node("Mul", ["b", "sigmoid"], ["silu"]),
        helper.make_node("Add", ["silu", "tanh"], ["block"]),
        helper.make_node("Concat", ["block", "x"], ["wide"], axis=1),
        helper.make_node("Gemm", ["wide", "c.weight", "c.bias"], ["c"], transB=1),
        helper.make_node("Reshape", ["c", "sides"], ["out"]),
    ]
    tensors = [tensor(f"{name}.weight", *sides) for name, sides in (("a", (7, 9)), ("b", (7, 7)), ("c", (5, 16)))]
    tensors += [tensor(f"{name}.bias", width) for name, width in (("a", 7), ("b", 7), ("c", 5))]
    tensors.append(numpy_helper.from_array(np.array([-1, 5], np.int64), "sides"))
    write("residual.onnx", nodes, tensors, ("x", "out"), 18)


traced()
translated()
residual()
