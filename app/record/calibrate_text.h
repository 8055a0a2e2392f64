// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <variant>

#include "thermorig/core/profile.h"
#include "thermorig/rig/calibration/calibration.h"

namespace thermorig::app {

using CalibrationResult =
    std::variant<calibration::BiasResult, calibration::LatencyResult, calibration::ScaleResult,
                 calibration::OrientationResult, calibration::LensResult, calibration::EncoderResult>;

/// The result in words, and what `before` says of the same: lines for people.
std::string text_of(const CalibrationResult& result, const RigProfile& before);

/// The same as an object with the keys `result` and `before`.
nlohmann::json calibration_json(const CalibrationResult& result, const RigProfile& before);

}  // namespace thermorig::app
