// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "thermorig/core/estimate.h"

namespace thermorig::app {

/// null where there is no number: JSON has none for what is not finite.
nlohmann::json number_json(double value);
/// The double whose shortest text is the float's.
nlohmann::json number_json(float value);
nlohmann::json number_json(const std::optional<double>& value);

/// `value` and `uncertainty`; null where nothing was estimated.
nlohmann::json estimate_json(const std::optional<Estimate>& estimate);

/// null where there is no text.
nlohmann::json text_json(const std::string& text);

}  // namespace thermorig::app
