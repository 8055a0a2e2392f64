# SPDX-License-Identifier: MIT
"""Trains a network a little in PyTorch and exports it with torch.onnx.export, as somebody does who trains elsewhere.

    export_samples.py FOLDER    (writes one .onnx for every Nf, Nr, fusion and thermal-only)
"""
import pathlib
import sys

import torch

from fusion_network import FusionNetwork, save_onnx, training_loss
from seeded_values import seeded_batch, seeded_weights

SEED = 7


def trained(frames, reduction, fusion, steps=3):
    network = FusionNetwork(frames, reduction, fusion)
    network.set_weights(seeded_weights(network, SEED))
    adam = torch.optim.Adam(network.parameters(), lr=1e-3)
    for step in range(steps):
        batch = seeded_batch(SEED, step, 8, frames, network.rows, network.columns)
        adam.zero_grad()
        training_loss(network, *map(torch.from_numpy, batch)).backward()
        adam.step()
    return network


def main(folder):
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    for frames in range(2, 7):
        for reduction in (1, 2, 3):
            for fusion in (True, False):
                name = f"nf{frames}_nr{reduction}_{'fusion' if fusion else 'thermal'}.onnx"
                save_onnx(trained(frames, reduction, fusion), folder / name)


if __name__ == "__main__":
    main(*sys.argv[1:])
