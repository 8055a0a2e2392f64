// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "gyro_integral.h"
#include "intervals.h"
#include "shaft_curve.h"
#include "thermorig/core/estimate.h"
#include "thermorig/core/sync.h"
#include "thermorig/pipeline/labels/pulse_scale.h"

namespace thermorig::labels {

/// How far the shaft turns for what is commanded, as the gyro sees it.
struct GainFit {
  Estimate ratio;            // corrected gyro over model, mean over what was visited
  std::vector<double> gain;  // relative to it, at evenly spaced pulse widths
  double bias_dps = 0.0;     // what is left of the gyro's bias
  // The same over time, where it moved; empty: it did not. Seconds of the gyro's integral.
  std::vector<std::pair<double, double>> bias_course;

  /// What is left of the gyro's bias at that time.
  double bias_at(double time_s) const;
};

/// Least squares over windows of five pulse periods in motion. Between its knots the gain runs straight;
/// knots that were hardly visited are held by their neighbours. `curve`: the whole recording, its loop as
/// fitted; `bias_uncertainty_dps`: of the bias that was already removed; `strayed`: where the shaft turned
/// otherwise than commanded. Where both directions say that the bias moved, it has a course. None without
/// motion.
std::optional<GainFit> fit_gain(const ShaftCurve& curve, double begin_s, double end_s, double delay_s,
                                const PulseScale& scale, const GyroIntegral& gyro,
                                double bias_uncertainty_dps, std::span<const Interval> strayed);

}  // namespace thermorig::labels
