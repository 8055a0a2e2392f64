# SPDX-License-Identifier: MIT
"""The data set for PyTorch; skipped (77) where torch is not installed, but never where everything is asked for
(tests/nightly.sh, which installs it).

Usage: torch_test.py
"""
import os
import sys
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "app/python"))

try:
    import torch
except ModuleNotFoundError:
    print("torch is not installed (bash app/setup.sh torch): nothing was tested")
    sys.exit(1 if os.environ.get("THERMORIG_EVERYTHING") else 77)

import numpy as np  # noqa: E402

import thermorig  # noqa: E402
from thermorig.torch import WindowDataset  # noqa: E402

random = np.random.default_rng(1)
count = 5
data = thermorig.Windows(images=random.normal(25, 3, (count, 3, 24, 32)).astype(np.float32),
                         label_dps=np.arange(count, dtype=np.float32),
                         gyro_dps=np.arange(count, dtype=np.float32) + 1, last=np.arange(count, dtype=np.uint32),
                         session=np.zeros(count, np.uint32), middle_s=np.arange(count, dtype=np.float64),
                         names=("garden_acq-01",))
scaling = thermorig.Scaling(25.0, 3.0, 200.0)

plain = WindowDataset(data, scaling)
assert len(plain) == count
images, gyro, label = plain[3]
assert torch.equal(images, torch.from_numpy(data.normalised(scaling).images[3]))
assert float(label) == np.float32(3) / np.float32(200) and float(gyro) == np.float32(4) / np.float32(200)

mirrored = WindowDataset(data, scaling, mirror=True)
assert len(mirrored) == 2 * count
flipped, gyro_back, label_back = mirrored[7]
assert torch.equal(flipped, images.flip(-1)) and gyro_back == -gyro and label_back == -label
batch = next(iter(torch.utils.data.DataLoader(mirrored, batch_size=4)))
assert [tuple(part.shape) for part in batch] == [(4, 3, 24, 32), (4,), (4,)]
