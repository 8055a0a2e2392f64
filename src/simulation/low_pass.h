// SPDX-License-Identifier: MIT
#pragma once

namespace thermorig::simulation {

/// A low-pass of second order (Butterworth) on evenly spaced values, by the bilinear transform.
class LowPass {
 public:
  /// `bandwidth_hz`: where the amplitude has fallen by 3 dB; below half of the values' rate.
  LowPass(double bandwidth_hz, double step_s);

  /// As if `value` had been there for ever.
  void settle(double value);
  double next(double value);

  /// Group delay of what is slow.
  double delay_s() const { return delay_s_; }

 private:
  double gain_, feedback_1_, feedback_2_;
  double delay_s_;
  double in_1_ = 0.0, in_2_ = 0.0, out_1_ = 0.0, out_2_ = 0.0;  // the values before
};

}  // namespace thermorig::simulation
