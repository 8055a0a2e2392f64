// SPDX-License-Identifier: MIT
#include "number_json.h"

#include <array>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

namespace thermorig::app {

nlohmann::json number_json(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json();
}

nlohmann::json number_json(float value) {
  if (!std::isfinite(value)) return {};
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  double same = 0.0;
  std::from_chars(text.data(), end, same);
  return same;
}

nlohmann::json number_json(const std::optional<double>& value) {
  return value ? number_json(*value) : nlohmann::json();
}

nlohmann::json estimate_json(const std::optional<Estimate>& estimate) {
  if (!estimate) return {};
  return {{"value", number_json(estimate->value)}, {"uncertainty", number_json(estimate->uncertainty)}};
}

nlohmann::json text_json(const std::string& text) {
  return text.empty() ? nlohmann::json() : nlohmann::json(text);
}

}  // namespace thermorig::app
