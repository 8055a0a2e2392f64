// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json.hpp>

#include "thermorig/learning/study/evaluation.h"

namespace thermorig::report {

// Parts of both JSON reports. Keys carry units; NaN becomes null.
nlohmann::json errors_json(const study::PerEstimator<study::Errors>& errors);
nlohmann::json bounds_json(const study::BoundErrors& bounds);
nlohmann::json sigma_json(const study::GateSigma& sigma);
nlohmann::json gain_json(const study::GainStatistics& gain);
nlohmann::json speeds_json(const std::vector<study::SpeedErrors>& speeds);
/// Drift and worst error, without the lines.
nlohmann::json drift_json(const study::AngleTrack& track);

/// The number with four significant digits, null if it is not finite: for drawing.
nlohmann::json drawn(double value);
nlohmann::json drawn(const std::vector<double>& values);

/// One text: indented, bytes that are no UTF-8 replaced, ends with a line end.
std::string json_text(const nlohmann::json& json);

}  // namespace thermorig::report
