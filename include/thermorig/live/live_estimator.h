// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <optional>

#include "thermorig/core/live_estimate.h"
#include "thermorig/core/measurement.h"
#include "thermorig/model/model.h"
#include "thermorig/network/estimator.h"

namespace thermorig::live {

/// Frame by frame: the window of the last Nf frames, its mean gyro and label, what the network says of it.
/// Pure and deterministic: the same frames and samples give the same rows, bit for bit (with kernels of the
/// same instruction set). No call allocates.
///
/// A window is complete when none of its frames but the first has lost frames or damaged bytes before it, and
/// no pixel is out of range: then the network is asked, be the label valid or not. `counted` follows
/// windows::WindowRule, as in training: every label, gyro mean and pixel of the window is known and sound.
/// Without a known gyro the thermal head speaks alone.
class LiveEstimator {
 public:
  /// Without a model: gyro against label only, each frame its own window.
  explicit LiveEstimator(const std::optional<model::Model>& model,
                         network::Precision precision = network::Precision::fp32);
  ~LiveEstimator();
  LiveEstimator(LiveEstimator&&) noexcept;
  LiveEstimator& operator=(LiveEstimator&&) noexcept;

  /// `arrived`: of the chunk that completed the measurement.
  LiveEstimate add(const Measurement& measurement, HostTime arrived);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace thermorig::live
