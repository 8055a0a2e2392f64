// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "gyro_integral.h"
#include "shaft_curve.h"
#include "thermorig/core/estimate.h"
#include "thermorig/core/sync.h"
#include "thermorig/fit/shaft/intervals.h"
#include "thermorig/pipeline/labels/pulse_train.h"

namespace thermorig::fit {

/// What was commanded, and the gyro that saw what came of it, over a whole recording.
struct ShaftEvidence {
  const ShaftCurve& curve;  // its loop as fitted
  double begin_s, end_s;
  double delay_s;  // from the curve to the shaft
  PulseScale scale;
  const GyroIntegral& gyro;
  std::span<const Interval> strayed;  // where the shaft turned otherwise than commanded
};

/// How far the shaft turns for what is commanded, as the gyro sees it.
struct GainFit {
  Estimate ratio;                              // corrected gyro over model, mean over what was visited
  std::vector<double> gain;                    // relative to it, at evenly spaced pulse widths
  std::vector<ServoResponse::Ripple> ripples;  // of the periods that were asked for
  double bias_dps = 0.0;                       // what is left of the gyro's bias
  // The same over time, where it moved; empty: it did not. Seconds of the gyro's integral.
  std::vector<std::pair<double, double>> bias_course;

  /// What is left of the gyro's bias at that time.
  double bias_at(double time_s) const;
};

/// Least squares over windows of five pulse periods in motion. Between its knots the gain runs straight;
/// knots that were hardly visited are held by their neighbours. Ripples are fitted beside it, where
/// `before`, a fit of the same evidence, has the shaft's angle. `bias_uncertainty_dps`: of the bias that was
/// already removed. Where both directions say that the bias moved, it has a course. None without motion.
std::optional<GainFit> fit_gain(const ShaftEvidence& evidence, double bias_uncertainty_dps,
                                std::span<const double> ripple_periods_deg = {}, const GainFit& before = {});

/// The same; ripples are looked for in what it leaves (ripple_search.h), and fitted as long as there are
/// some.
std::optional<GainFit> fit_gain_and_ripples(const ShaftEvidence& evidence, double bias_uncertainty_dps);

}  // namespace thermorig::fit
