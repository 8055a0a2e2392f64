# SPDX-License-Identifier: MIT
"""Makes golden.txt: what PyTorch says of small networks, in double precision. Weights and batches follow from seeds
(../../interop/seeded_values.py), so only results are stored.

    python3 make_golden.py > golden.txt
"""
import pathlib
import sys

import numpy as np
import torch

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "interop"))
from fusion_network import FusionNetwork, training_loss  # noqa: E402
from seeded_values import seeded_batch, seeded_values, seeded_weights  # noqa: E402

STEPS = 24
SEED = 100
VALUES = 5  # of each gradient, evenly spread; the projection looks at all of them
PROJECTION_SEED = 999

CASES = {
    "fusion": dict(),
    "fusion_auxiliary": dict(auxiliary=0.5),
    "thermal_only": dict(fusion=False),
    "small_batch": dict(samples=7),
    "one_sample": dict(samples=1),
    "mirrored": dict(mirrored=True, auxiliary=0.5),
    "less_padding": dict(frames=2, reduction=2, padding1=0, padding2=2),
}


def batch_of(case, network, number):
    frames, gyro, label = seeded_batch(SEED, number, case["samples"], network.frames, network.rows, network.columns)
    if case["mirrored"]:
        frames[1::2] = frames[1::2, :, :, ::-1].copy()
        gyro[1::2] *= -1
        label[1::2] *= -1
    return [torch.from_numpy(values).double() for values in (frames, gyro, label)]


def print_gradients(network):
    for name, parameter in network.named_parameters():
        gradient = parameter.grad.reshape(-1).numpy()
        projection = float(gradient @ seeded_values(PROJECTION_SEED, gradient.size).astype(np.float64))
        chosen = [int(i) for i in np.linspace(0, gradient.size - 1, min(VALUES, gradient.size))]
        print("gradient", name, f"{np.abs(gradient).max():.9g} {projection:.9g}", len(chosen),
              *(f"{i} {gradient[i]:.9g}" for i in chosen))


def print_outputs(case, network):
    frames, gyro, _ = batch_of(case, network, 0)
    with torch.no_grad():
        outputs = network(frames, gyro.unsqueeze(1))
    if not network.fusion:
        outputs = (outputs, outputs, torch.ones_like(outputs))
    print("outputs", case["samples"], *(f"{value:.9g}" for row in torch.cat(outputs, 1).tolist() for value in row))


def print_case(name, case):
    case = dict(frames=3, reduction=3, fusion=True, padding1=2, padding2=2, auxiliary=0.0, samples=32,
                mirrored=False) | case
    network = FusionNetwork(*(case[key] for key in ("frames", "reduction", "fusion", "padding1", "padding2")))
    network.set_weights(seeded_weights(network, SEED))
    network.double()
    print("case", name, *(f"{key} {value + 0:g}" for key, value in case.items()))
    print_outputs(case, network)
    adam = torch.optim.Adam(network.parameters(), lr=1e-3)
    losses = []
    for step in range(STEPS):
        adam.zero_grad()
        loss = training_loss(network, *batch_of(case, network, step), case["auxiliary"])
        loss.backward()
        if step == 0:
            print_gradients(network)
        adam.step()
        losses.append(float(loss))
    print("losses", STEPS, *(f"{loss:.9g}" for loss in losses))


if __name__ == "__main__":
    print("# SPDX-License-Identifier: MIT")
    print(f"# Made by make_golden.py with PyTorch {torch.__version__}; seed {SEED}, projection seed {PROJECTION_SEED}.")
    print("# outputs: fusion, thermal, gain of each sample; gradient: name, largest, projection, chosen index and value.")
    for case_name, settings in CASES.items():
        print_case(case_name, settings)
