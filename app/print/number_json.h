// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

namespace thermorig::app {

/// null where there is no number: JSON has none for what is not finite.
nlohmann::json number_json(double value);
/// The double whose shortest text is the float's.
nlohmann::json number_json(float value);
nlohmann::json number_json(const std::optional<double>& value);

/// null where there is no text.
nlohmann::json text_json(const std::string& text);

}  // namespace thermorig::app
