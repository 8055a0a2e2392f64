// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "thermorig/core/label.h"
#include "thermorig/network/camera_view.h"
#include "thermorig/network/scaling.h"
#include "thermorig/network/weights.h"

namespace thermorig::model {

/// Where a model comes from. No time, machine or path: the same training gives the same bytes.
struct Provenance {
  struct Data {
    std::string name;  // of the acquisition
    std::string hash;  // network::Acquisition::hash
  };
  std::string producer;  // program and version, e.g. "thermorig 0.1.0"; of a foreign file what it says
  std::string preset;    // "paper", "best" or "custom"; empty if unknown
  std::uint64_t seed = 0;
  int epochs = 0;              // trained
  int epoch_kept = 0;          // whose weights these are, from 1
  std::vector<Data> training;  // acquisitions trained on
  std::vector<Data> held_out;  // acquisitions that chose the epoch
  bool simulated = false;      // any of them
  std::string data_licence;    // of the training data
  std::optional<Label> label;  // that was learnt; none: a foreign file does not say
  // Of networks that scale by the window; others do not say it.
  std::optional<network::CameraView> view;  // of the camera whose images were learnt; none: of several
  std::uint64_t made_windows = 0;           // of made-up rooms, counted each time that one was shown
  std::string begun_from;                   // the network that the training began with; empty: none
};

/// A trained network with all that is needed to use it.
struct Model {
  network::Weights weights;  // its shape is in it
  network::Scaling scaling;
  Provenance provenance;
};

/// The model as ONNX (opset 13, IR 8). Inputs `frames` (N, Nf, H, W) and `gyro` (N, 1), outputs `fusion`,
/// `thermal` and `gain` (N, 1); a thermal-only model has `frames` and `thermal`. Names, metadata and limits:
/// docs/model_format.md. Deterministic. `batch` > 0 fixes N.
std::string to_onnx(const Model& model, int batch = 0);

/// Reads what `to_onnx` wrote, or a network of the same graph made elsewhere with the documented names.
/// Hostile bytes are refused with Error(not_a_session): what is wrong, `where`, what to try. Never allocates
/// by what the file claims.
Model from_onnx(std::span<const std::uint8_t> bytes, const std::string& where);

/// CRC-32 of the weights, hexadecimal: `weights_crc32` of the file.
std::string sum_of(const network::Weights& weights);

/// Throws Error(storage) if it cannot be written; written to a temporary name, synced, renamed.
void write_model(const std::filesystem::path& path, const Model& model, int batch = 0);
Model read_model(const std::filesystem::path& path);

}  // namespace thermorig::model
