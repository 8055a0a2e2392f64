// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <span>

#include "thermorig/network/instruction_set.h"
#include "thermorig/network/weights.h"

namespace thermorig::network {

/// What the network says of one window; speeds normalised (divided by the label scale).
struct Output {
  float fusion = 0.0F;   // y_fus = Kg * y_th + (1 - Kg) * mean gyro (paper eq. 2); thermal-only: y_th
  float thermal = 0.0F;  // y_th
  float gain = 1.0F;     // Kg, 0..1; thermal-only: 1
};

enum class Precision : unsigned char {
  fp32,
  fp16_weights
};  // fp16: the two big layers' weights are stored in half precision, those beyond it as its largest, 65504

/// The fusion of these with another mean gyro, normalised, bit for bit as the network would have made it.
float fusion_of(const Output& output, float gyro);

/// Runs the network on one window at a time. Allocates only when made. Not for two threads at once.
class Estimator {
 public:
  explicit Estimator(const Weights& weights, Precision precision = Precision::fp32,
                     InstructionSet set = best_instruction_set());
  ~Estimator();
  Estimator(Estimator&&) noexcept;
  Estimator& operator=(Estimator&&) noexcept;

  const Shape& shape() const;

  /// `frames`: (Nf, H, W), oldest frame first, normalised; `gyro`: mean over the frames, normalised (ignored
  /// by a thermal-only net).
  Output estimate(std::span<const float> frames, float gyro);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace thermorig::network
