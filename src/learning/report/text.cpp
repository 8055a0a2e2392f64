// SPDX-License-Identifier: MIT
#include "text.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace thermorig::report {

std::string mse_text(double mse) {
  if (!std::isfinite(mse)) return no_value;
  const double size = std::abs(mse);
  if (size >= 0.00095 || size == 0.0) return fmt::format("{:.4f}", mse);
  if (size < 1e-8) return fmt::format("{:.1e}", mse);
  return fmt::format("{:.{}f}", mse, 1 - static_cast<int>(std::floor(std::log10(size))));  // two digits
}

std::string rate_text(double dps) {
  if (!std::isfinite(dps)) return no_value;
  return std::abs(dps) < 0.995 ? fmt::format("{:.2f}", dps) : fmt::format("{:.1f}", dps);
}

std::string angle_text(double deg) {
  if (!std::isfinite(deg)) return no_value;
  return std::abs(deg) < 99.95 ? fmt::format("{:.1f}", deg) : fmt::format("{:.0f}", deg);
}

std::string share_text(double share) {
  if (!std::isfinite(share)) return no_value;
  const double percent = 100.0 * share;
  const bool fine = percent != 0.0 && percent != 100.0 && (percent < 1.0 || percent > 99.0);
  return fmt::format("{:.{}f} %", percent, fine ? 2 : 0);
}

std::string setting_text(int frames, int reduction) {
  return fmt::format("Nf = {}, Nr = {}", frames, reduction);
}

std::string clean(const std::string& text) {
  const nlohmann::json raw = text;
  const auto valid = raw.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  std::string cleaned = nlohmann::json::parse(valid).get<std::string>();
  for (char& c : cleaned)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = ' ';
  return cleaned;
}

}  // namespace thermorig::report
