// SPDX-License-Identifier: MIT
#pragma once

namespace thermorig::labels {

/// Variance of means over one pulse period each, by three that follow each other: how far the middle one lies
/// from the line between its neighbours. It hears what is faster than some 12 Hz, which is too fast to move a
/// shaft with a camera on it by a part of a pixel; pulses average out.
inline double alternation_dps2(double before_dps, double middle_dps, double after_dps) {
  const double off_dps = before_dps - 2.0 * middle_dps + after_dps;
  return off_dps * off_dps / 6.0;
}

}  // namespace thermorig::labels
