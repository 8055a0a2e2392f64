// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "gyro_integral.h"
#include "thermorig/core/estimate.h"
#include "thermorig/core/profile.h"
#include "thermorig/fit/shaft/intervals.h"

namespace thermorig::fit {

/// What the shaft made of a commanded speed, by the gyro alone: no model of the servo is in it.
struct ReachedSpeed {
  double rate_dps = 0.0;     // commanded
  double reached_dps = 0.0;  // mean of the corrected gyro over the steady parts of its legs
  bool contradicts = false;  // further from the other speeds' share of the command than bias, scale and a
                             // servo's slope along its travel explain
};

/// Of the legs, ascending by the commanded speed. `legs`: steady intervals, in seconds of `gyro`;
/// `bias_uncertainty_dps`: of what is left of the gyro's bias.
std::vector<ReachedSpeed> reached_speeds(std::span<const Interval> legs, const GyroIntegral& gyro,
                                         double bias_uncertainty_dps, ServoKind kind);

/// What the slower half of the speeds reach for each deg/s commanded: what a weak servo fails at first is
/// speed. None: none of them is fast enough to say.
std::optional<Estimate> reached_share(const std::vector<ReachedSpeed>& speeds, double bias_uncertainty_dps,
                                      ServoKind kind);

/// Where the shaft turns otherwise than commanded: legs at speeds that contradict, until it has caught up.
std::vector<Interval> strayed_intervals(std::span<const Interval> legs, std::span<const ReachedSpeed> speeds);

/// Whether a time lies in one of them. They ascend.
bool is_within(std::span<const Interval> intervals, double time_s);

}  // namespace thermorig::fit
