# SPDX-License-Identifier: MIT
"""PyTorch's side of network_peers.sh, Nf = 3, Nr = 1, fusion; answers as worker.h says.

    pytorch.py WEIGHTS      (float32 in the documented order)
"""
import itertools
import json
import statistics
import sys
import time

import numpy as np
import torch

from fusion_network import FusionNetwork, training_loss
from seeded_values import seeded_batch

SEED, WINDOWS, BATCH = 100, 8, 32  # as workload.h


def read_network(path):
    network = FusionNetwork()
    values = torch.from_numpy(np.fromfile(path, np.float32))
    torch.nn.utils.vector_to_parameters(values, network.parameters())
    return network


def data(samples):
    return [torch.from_numpy(values) for values in seeded_batch(SEED, 0, samples, 3, 24, 32)]


def inference(network):
    frames, gyro, _ = data(WINDOWS)
    windows = itertools.cycle([(frames[i:i + 1].clone(), gyro[i:i + 1].unsqueeze(1)) for i in range(WINDOWS)])

    def call():
        with torch.inference_mode():
            return network(*next(windows))[0].item()

    return call


def training(network):
    batch = data(BATCH)
    adam = torch.optim.Adam(network.parameters(), lr=1e-3, foreach=False)  # here faster than foreach=True

    def call():
        adam.zero_grad()
        loss = training_loss(network, *batch)
        loss.backward()
        adam.step()
        return loss.item()

    return call


def answer(call, groups, calls):
    processor, wall = [], []
    for _ in range(groups):
        begin, wall_begin = time.process_time_ns(), time.perf_counter_ns()
        for _ in range(calls):
            call()
        processor.append((time.process_time_ns() - begin) * 1e-3 / calls)
        wall.append((time.perf_counter_ns() - wall_begin) * 1e-3 / calls)
    print(json.dumps({"processor_us": statistics.median(processor), "wall_us": statistics.median(wall)}), flush=True)


def main(weights):
    torch.set_num_threads(1)
    torch.set_flush_denormal(True)  # as a training of ours does
    tasks = {"infer": inference(read_network(weights)), "train": training(read_network(weights))}
    for line in sys.stdin:
        task, groups, calls = line.split()
        answer(tasks[task], int(groups), int(calls))


if __name__ == "__main__":
    main(*sys.argv[1:])
