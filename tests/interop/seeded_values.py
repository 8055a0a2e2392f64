# SPDX-License-Identifier: MIT
"""Weights and batches by a formula that C++ (seeded_values.h) and Python compute to the same bits, so that no data need
be stored or passed on."""
import numpy as np

BATCHES = 4  # different ones; a loss path goes through them in turn
LIVELY = np.float32(1.7320508)  # uniform numbers in -1..1 times this have a deviation of 1


def seeded_values(seed, count):
    """`count` numbers in -1 <= x < 1, each exactly a float: the upper bits of SplitMix64 (Steele et al. 2014)."""
    with np.errstate(over="ignore"):
        state = (np.uint64(seed) << np.uint64(32)) + np.arange(1, count + 1, dtype=np.uint64)
        state = state * np.uint64(0x9E3779B97F4A7C15)
        state = (state ^ (state >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        state = (state ^ (state >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
        state = state ^ (state >> np.uint64(31))
    return ((state >> np.uint64(40)).astype(np.float64) / 2**23 - 1.0).astype(np.float32)


def seeded_weights(network, seed):
    """One array a tensor, in the order of `network.named_parameters()`: uniform in +-1/sqrt(fan-in)."""
    weights, fan_in = [], 1
    for index, (name, parameter) in enumerate(network.named_parameters()):
        if name.endswith(".weight"):
            fan_in = int(np.prod(parameter.shape[1:]))
        values = seeded_values(seed + index, parameter.numel()).astype(np.float64) / np.sqrt(float(fan_in))
        weights.append(values.astype(np.float32).reshape(parameter.shape))
    return weights


def seeded_batch(seed, number, samples, frames, rows, columns):
    """Frames (samples, Nf, H, W), gyro and label (samples) of batch `number`; batches repeat after BATCHES."""
    first = seed + 3 * (number % BATCHES)
    pixels = seeded_values(first, samples * frames * rows * columns) * LIVELY
    label = seeded_values(first + 1, samples)
    gyro = label + np.float32(0.25) * seeded_values(first + 2, samples)
    return pixels.reshape(samples, frames, rows, columns), gyro, label
