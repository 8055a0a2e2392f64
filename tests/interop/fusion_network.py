# SPDX-License-Identifier: MIT
"""The network as a PyTorch module with the names that thermorig's model files have (docs/model_format.md)."""
import onnx
import torch
from torch import nn
from torch.nn import functional


class FusionNetwork(nn.Module):
    """Nf = frames, Nr = reduction. Without fusion: the thermal-only network."""

    def __init__(self, frames=3, reduction=1, fusion=True, padding1=2, padding2=2):
        super().__init__()
        self.frames, self.fusion = frames, fusion
        self.rows, self.columns = 24 // reduction, 32 // reduction
        pooled = [(side + 2 * padding1 - 4) // 2 for side in (self.rows, self.columns)]
        features = 16 * (pooled[0] + 2 * padding2 - 4) * (pooled[1] + 2 * padding2 - 4)
        self.conv1 = nn.Conv2d(frames, 6, 5, padding=padding1)
        self.conv2 = nn.Conv2d(6, 16, 5, padding=padding2)
        self.speed1 = nn.Linear(features, 120)
        self.speed2 = nn.Linear(120, 80)
        self.speed3 = nn.Linear(80, 1)
        if fusion:
            self.gain1 = nn.Linear(features, 120)
            self.gain2 = nn.Linear(120, 1)

    def forward(self, frames, gyro=None):
        """frames (N, Nf, H, W), gyro (N, 1) -> fusion, thermal, gain, each (N, 1); thermal-only: thermal alone."""
        maps = functional.max_pool2d(functional.relu(self.conv1(frames)), 2)
        maps = functional.relu(self.conv2(maps))
        flat = torch.flatten(maps, 1)
        thermal = self.speed3(functional.relu(self.speed2(functional.relu(self.speed1(flat)))))
        if not self.fusion:
            return thermal
        gain = torch.sigmoid(self.gain2(functional.relu(self.gain1(flat))))
        return gain * thermal + (1 - gain) * gyro, thermal, gain

    def set_weights(self, arrays):
        """One array a tensor, in the documented order."""
        with torch.no_grad():
            for parameter, values in zip(self.parameters(), arrays):
                parameter.copy_(torch.from_numpy(values).reshape(parameter.shape))


def berhu(error, fraction=0.2):
    """Inverted Huber, mean over the batch; c is a constant to the gradient."""
    size = error.abs()
    c = (fraction * size.max()).detach()
    return torch.where(size <= c, size, (error * error + c * c) / (2 * c)).mean()


def training_loss(network, frames, gyro, label, auxiliary_thermal=0.0):
    """Batch tensors: frames (N, Nf, H, W), gyro and label (N)."""
    if not network.fusion:
        return berhu(network(frames).squeeze(1) - label)
    fusion, thermal, _ = network(frames, gyro.unsqueeze(1))
    loss = berhu(fusion.squeeze(1) - label)
    if auxiliary_thermal > 0:
        loss = loss + auxiliary_thermal * berhu(thermal.squeeze(1) - label)
    return loss


def save_onnx(network, path, label_scale_dps=200.0, temp_mean_c=25.0, temp_deviation_c=3.0):
    """As anybody would export it, with the documented names of inputs and outputs and the scaling that the network was
    trained with."""
    path = str(path)
    frames = torch.zeros(1, network.frames, network.rows, network.columns)
    inputs, outputs = (frames,), ["thermal"]
    names = ["frames"]
    if network.fusion:
        inputs, names = (frames, torch.zeros(1, 1)), ["frames", "gyro"]
        outputs = ["fusion", "thermal", "gain"]
    torch.onnx.export(network, inputs, path, input_names=names, output_names=outputs, opset_version=13,
                      dynamic_axes={name: {0: "N"} for name in names + outputs})
    model = onnx.load(path)
    onnx.helper.set_model_props(model, {"label_scale_dps": str(label_scale_dps), "temp_mean_c": str(temp_mean_c),
                                        "temp_deviation_c": str(temp_deviation_c)})
    onnx.save(model, path)
