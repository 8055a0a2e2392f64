// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>

#include "thermorig/network/estimator.h"
#include "thermorig/network/shape.h"

namespace thermorig::network {

/// One of the eight symmetries of a window: what a camera could have seen as well, at the same speed or its
/// negative. Bits: 1 mirrored left to right, 2 upside down, 4 the frames backwards in time.
class Turn {
 public:
  static constexpr std::uint8_t all = 8;

  constexpr explicit Turn(std::uint8_t bits = 0) : bits_(bits) {}
  constexpr bool mirrored() const { return (bits_ & 1U) != 0; }
  constexpr bool upside_down() const { return (bits_ & 2U) != 0; }
  constexpr bool backwards() const { return (bits_ & 4U) != 0; }
  /// Of the speed of the turned window against that of the window.
  constexpr float sign() const { return mirrored() != backwards() ? -1.0F : 1.0F; }
  /// The same without the mirror, which the kernels do while they load.
  constexpr Turn without_mirror() const { return Turn(bits_ & 6U); }
  constexpr bool is_none() const { return bits_ == 0; }
  constexpr std::uint8_t bits() const { return bits_; }

 private:
  std::uint8_t bits_;
};

/// `from` and `turned`: (Nf, H, W), not the same memory.
void turn_window(std::span<const float> from, const Shape& shape, Turn turn, std::span<float> turned);

/// What a network says of a window whose turns it was shown: their mean, each weighed by the odds of its gate
/// (a thermal-only net: alike); the gate's own by the mean of its logits. Eight together are surer than each,
/// by 1.5 in the odds (measured on simulated rooms).
class TurnedOutputs {
 public:
  void add(const Output& output, Turn turn, bool fusion);
  /// Of all so far, at least one. `gyro`: normalised.
  Output mean(float gyro, bool fusion) const;

 private:
  double count_ = 0.0, odds_ = 0.0, speed_ = 0.0, logit_ = 0.0;
};

}  // namespace thermorig::network
