// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "thermorig/core/profile.h"
#include "thermorig/core/sample.h"
#include "thermorig/core/sync.h"

namespace thermorig::fit {

/// How the shaft follows the pulses, by the corrected gyro: delay and bandwidth from ramps and reversals; the
/// scale is the mean of what profile and gyro say, by how well each is known. Residuals are means over
/// `frame_period_s`, of the legs only. Speeds at which the shaft turns otherwise than commanded take no part
/// in the fit. Fills in `errors.bias_course` where both directions say that the bias moved.
/// Of a gyro whose rate decays nothing is taken.
/// Where `witnesses` have an outlier, nothing is made of it: the scale is the gyro's alone if the command is
/// one, and nothing is fitted if the gyro is one or nobody knows; all speeds then contradict the command.
/// `longest_gap_s`: what came in a longer silence of telemetry is not known.
ServoResponse fit_servo_response(std::span<const TimedServo> servo, std::span<const TimedGyro> gyro,
                                 GyroErrors& errors, const ServoProfile& profile,
                                 double frame_period_s = 0.125, const Witnesses& witnesses = {},
                                 double longest_gap_s = 0.05);

}  // namespace thermorig::fit
