# SPDX-License-Identifier: MIT
"""Runs a model file's graph with numpy, operator by operator as ONNX defines them. run_graph.py MODEL INPUTS: float32
frames (Nf, 24, 32), period, gyro of one window; prints fusion, thermal and gain, or thermal alone."""
import sys

import numpy as np
import onnx
from onnx import numpy_helper


def blocks(x, size, step):
    """(N, C, H, W) to (N, C, rows, columns, size, size)."""
    windows = np.lib.stride_tricks.sliding_window_view(x, (size, size), axis=(2, 3))
    return windows[:, :, ::step, ::step]


def convolve(x, weights, bias, pads):
    padded = np.pad(x, ((0, 0), (0, 0), (pads[0], pads[2]), (pads[1], pads[3])))
    return np.einsum("ncyxij,ocij->noyx", blocks(padded, weights.shape[2], 1), weights) + bias[None, :, None, None]


OPERATORS = {
    "AveragePool": lambda a, x: blocks(x, a["kernel_shape"][0], a["strides"][0]).mean(axis=(4, 5)),
    "MaxPool": lambda a, x: blocks(x, a["kernel_shape"][0], a["strides"][0]).max(axis=(4, 5)),
    "Conv": lambda a, x, w, b: convolve(x, w, b, a["pads"]),
    "Gemm": lambda a, x, w, b: x @ w.T + b,
    "Flatten": lambda a, x: x.reshape(len(x), -1),
    "ReduceMean": lambda a, x: x.mean(axis=tuple(a["axes"]), keepdims=True),
    "ReduceSum": lambda a, x, axes: x.sum(axis=tuple(axes), keepdims=True),
    "Cast": lambda a, x: x.astype(np.float32),
    "LessOrEqual": lambda a, x, y: x <= y,
    "Clip": lambda a, x, least, most: np.clip(x, least, most),
    "Relu": lambda a, x: np.maximum(x, 0),
    "Sigmoid": lambda a, x: 1 / (1 + np.exp(-x)),
    "Abs": lambda a, x: np.abs(x), "Sqrt": lambda a, x: np.sqrt(x),
    "Add": lambda a, x, y: x + y, "Sub": lambda a, x, y: x - y, "Mul": lambda a, x, y: x * y,
    "Div": lambda a, x, y: x / y, "Max": lambda a, x, y: np.maximum(x, y),
}

model = onnx.load(sys.argv[1])
frames = model.graph.input[0].type.tensor_type.shape.dim[1].dim_value
inputs = np.fromfile(sys.argv[2], np.float32)
values = {t.name: numpy_helper.to_array(t) for t in model.graph.initializer}
values["frames"] = inputs[:frames * 768].reshape(1, frames, 24, 32)
values["period"], values["gyro"] = inputs[frames * 768:].reshape(2, 1, 1)
for node in model.graph.node:
    attributes = {a.name: onnx.helper.get_attribute_value(a) for a in node.attribute}
    values[node.output[0]] = OPERATORS[node.op_type](attributes, *(values[name] for name in node.input))
print(*(float(values[output.name]) for output in model.graph.output))
