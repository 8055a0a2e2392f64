# SPDX-License-Identifier: MIT
"""Windows for PyTorch. Needs torch; nothing else of the package does."""

from __future__ import annotations

import torch
from torch.utils.data import Dataset

from .windows import Scaling, Windows


class WindowDataset(Dataset):  # type: ignore[type-arg]
    """Normalised windows, one after another: (images (Nf, H, W), gyro, label), float32.

    `mirror`: each second item is one of the first half again, flipped left to right with speeds negated, so there
    are twice as many.
    """

    def __init__(self, data: Windows, scaling: Scaling, mirror: bool = False) -> None:
        ready = data.normalised(scaling)
        self.images = torch.from_numpy(ready.images)
        self.gyro = torch.from_numpy(ready.gyro_dps)
        self.label = torch.from_numpy(ready.label_dps)
        self.mirror = mirror

    def __len__(self) -> int:
        return len(self.label) * (2 if self.mirror else 1)

    def __getitem__(self, item: int) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
        index = item // 2 if self.mirror else item
        images, gyro, label = self.images[index], self.gyro[index], self.label[index]
        if self.mirror and item % 2 == 1:
            return images.flip(-1), -gyro, -label
        return images, gyro, label
