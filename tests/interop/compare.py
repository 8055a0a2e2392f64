# SPDX-License-Identifier: MIT
"""Our network beside ONNX Runtime and PyTorch, for every Nf, Nr, fusion and thermal-only.

    compare.py NETWORK_INTEROP LIBONNXRUNTIME [--json] [--quick]
"""
import json
import pathlib
import statistics
import subprocess
import sys
import tempfile

import numpy as np
import torch

from export_samples import trained
from fusion_network import FusionNetwork, save_onnx, training_loss
from seeded_values import seeded_batch, seeded_values, seeded_weights

SEED = 100  # as in network_interop.cpp
WINDOWS = 1000
STEPS = 20
SAMPLES = 32
PATHS = 3  # loss paths a shape
DETERMINED = 1e-5  # by how much PyTorch's loss path may differ from itself
AUXILIARY = (0.0, 0.5)
OUTPUT_LIMIT, GRADIENT_LIMIT, LOSS_LIMIT = 1e-5, 1e-4, 1e-4


def shapes(quick):
    frames, reductions = ((3,), (1, 3)) if quick else (range(2, 7), (1, 2, 3))
    return [(nf, nr, fusion) for nf in frames for nr in reductions for fusion in (True, False)]


def mode(fusion):
    return "fusion" if fusion else "thermal-only"


class Interop:
    def __init__(self, program, folder):
        self.program, self.folder = program, folder

    def run(self, *arguments):
        return subprocess.run([self.program, *map(str, arguments)], check=True, capture_output=True, text=True).stdout


def onnx_runtime_differences(interop, library, windows):
    return [json.loads(line) for line in interop.run("onnx-runtime", library, windows).splitlines()]


def batch_of(network, seed, step, samples):
    batch = seeded_batch(seed, step, samples, network.frames, network.rows, network.columns)
    return [torch.from_numpy(values) for values in batch]


def torch_training(shape, auxiliary, seed, disturbed=None):
    """Gradients of the first batch by name, and the losses; `disturbed`: a seed that changes the weights' last bits."""
    network = FusionNetwork(*shape)
    weights = seeded_weights(network, seed)
    if disturbed is not None:
        weights = [np.nextafter(w, w + seeded_values(disturbed, w.size).reshape(w.shape)) for w in weights]
    network.set_weights(weights)
    adam = torch.optim.Adam(network.parameters(), lr=1e-3)
    gradients, losses = {}, []
    for step in range(STEPS):
        adam.zero_grad()
        loss = training_loss(network, *batch_of(network, seed, step, SAMPLES), auxiliary)
        loss.backward()
        if step == 0:
            gradients = {name: value.grad.numpy().copy() for name, value in network.named_parameters()}
        adam.step()
        losses.append(float(loss))
    return gradients, np.array(losses)


def our_training(interop, shape, auxiliary, seed, count):
    path = interop.folder / "training.bin"
    interop.run("training", shape[0], shape[1], mode(shape[2]), auxiliary, seed, SAMPLES, STEPS, path)
    data = path.read_bytes()
    return np.frombuffer(data, np.float32, count), np.frombuffer(data, np.float64, offset=8 * count)


def path_difference(losses, others):
    return float((np.abs(losses - others) / others).max())


def determined_trainings(shape, auxiliary):
    """The first seeds whose loss path PyTorch finds again from weights with other last bits: (seed, gradients, losses), and
    how many were passed over. Adam steps as far for a slope of 1e-9 as for one of 1, and ReLU, max-pooling and berHu have
    corners, so that now and then a rounding decides where a path goes, and PyTorch does not agree with itself."""
    found, passed_over = [], 0
    for seed in range(SEED, SEED + 10000, 100):
        gradients, losses = torch_training(shape, auxiliary, seed)
        again = [torch_training(shape, auxiliary, seed, disturbed)[1] for disturbed in (1, 2)]
        if max(path_difference(path, losses) for path in again) <= DETERMINED:
            found.append((seed, gradients, losses))
        else:
            passed_over += 1
        if len(found) == PATHS:
            return found, passed_over
    sys.exit(f"too few loss paths are determined: {shape}, auxiliary loss {auxiliary}")


class TrainingDifference:
    """Our training beside PyTorch's, from the same weights with the same batches. Our roundings are others than PyTorch's and
    may lead round a corner where PyTorch's do not: the loss path's difference is a median over seeds."""

    def __init__(self, interop, shape, auxiliary):
        self.gradient, self.paths = 0.0, []
        found, self.passed_over = determined_trainings(shape, auxiliary)
        for seed, gradients, losses in found:
            count = sum(values.size for values in gradients.values())
            ours, our_losses = our_training(interop, shape, auxiliary, seed, count)
            self.gradient = max(self.gradient, gradient_difference(ours, gradients))
            self.paths.append(path_difference(our_losses, losses))


def gradient_difference(ours, gradients):
    """The worst tensor's largest difference by its largest value."""
    worst, first = 0.0, 0
    for values in gradients.values():
        part = ours[first:first + values.size]
        worst = max(worst, float(np.abs(part - values.ravel()).max() / np.abs(values).max()))
        first += values.size
    return worst


def foreign_difference(interop, shape, windows):
    """A model trained and exported in PyTorch, read by us."""
    network = trained(*shape)
    model, outputs = interop.folder / "foreign.onnx", interop.folder / "outputs.bin"
    save_onnx(network, model)
    interop.run("outputs", model, windows, outputs)
    ours = np.fromfile(outputs, np.float32).reshape(windows, 3)
    frames, gyro, _ = batch_of(network, SEED, 0, windows)
    with torch.no_grad():
        theirs = network(frames, gyro.unsqueeze(1))
    if not shape[2]:
        theirs = (theirs, theirs, torch.ones_like(theirs))
    return float(np.abs(ours - torch.cat(theirs, 1).numpy()).max())


def reread_difference(interop, shape):
    """Our file's weights in PyTorch's module: the documented order, bit by bit."""
    model, raw = interop.folder / "seeded.onnx", interop.folder / "weights.bin"
    interop.run("seeded-model", shape[0], shape[1], mode(shape[2]), SEED, model)
    interop.run("weights", model, raw)
    network = FusionNetwork(*shape)
    expected = np.concatenate([values.ravel() for values in seeded_weights(network, SEED)])
    return float(np.abs(np.fromfile(raw, np.float32) - expected).max())


def measure(program, library, quick):
    with tempfile.TemporaryDirectory() as folder:
        interop = Interop(program, pathlib.Path(folder))
        every = shapes(quick)
        training = [TrainingDifference(interop, shape, auxiliary) for shape in every
                    for auxiliary in (AUXILIARY if shape[2] else AUXILIARY[:1])]
        peers = onnx_runtime_differences(interop, library, WINDOWS)
        return {
            "onnx_runtime_output_difference": (max(row["difference"] for row in peers), OUTPUT_LIMIT),
            "onnx_runtime_difference_from_degrees": (max(row["from_degrees"] for row in peers), OUTPUT_LIMIT),
            "onnx_runtime_shapes": (len(peers), None),
            "pytorch_gradient_difference": (max(row.gradient for row in training), GRADIENT_LIMIT),
            "pytorch_loss_path_difference": (max(statistics.median(row.paths) for row in training), LOSS_LIMIT),
            "pytorch_loss_paths": (sum(len(row.paths) for row in training), None),
            "pytorch_loss_paths_beyond_limit": (sum(path > LOSS_LIMIT for row in training for path in row.paths), None),
            "pytorch_loss_paths_that_differ_from_themselves": (sum(row.passed_over for row in training), None),
            "pytorch_export_output_difference":
                (max(foreign_difference(interop, shape, WINDOWS) for shape in every), OUTPUT_LIMIT),
            "model_file_weight_difference": (max(reread_difference(interop, shape) for shape in every), 0.0),
        }


def main(program, library, *options):
    torch.set_num_threads(1)
    figures = measure(program, library, "--quick" in options)
    if "--json" in options:
        print(json.dumps({name: value for name, (value, _) in figures.items()}, indent=1))
    else:
        for name, (value, limit) in figures.items():
            verdict = "" if limit is None else f"  <= {limit:g}: {'met' if value <= limit else 'NOT MET'}"
            print(f"{name:40} {value:10.3g}{verdict}")
    return int(any(limit is not None and not value <= limit for value, limit in figures.values()))


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
