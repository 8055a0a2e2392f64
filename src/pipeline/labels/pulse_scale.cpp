// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/labels/pulse_scale.h"

#include <algorithm>

namespace thermorig::labels {

namespace {
constexpr double least_width_us = 1.0;  // of a profile that makes no sense
constexpr double least_span = 1.0;
}  // namespace

PulseScale::PulseScale(const ServoProfile& servo)
    : continuous_(servo.kind == ServoKind::continuous),
      middle_us_((servo.pulse_min_us + servo.pulse_max_us) / 2.0),
      half_span_(std::max(continuous_ ? servo.full_rate_dps : servo.travel_deg / 2.0, least_span)),
      value_per_us_(half_span_ / std::max((servo.pulse_max_us - servo.pulse_min_us) / 2.0, least_width_us)) {}

}  // namespace thermorig::labels
