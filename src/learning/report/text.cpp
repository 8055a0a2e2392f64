// SPDX-License-Identifier: MIT
#include "text.h"

#include <fmt/format.h>

#include <cctype>
#include <cmath>
#include <nlohmann/json.hpp>

#include "document.h"

namespace thermorig::report {
namespace {

/// A figure or two, such as "0.0122" and "-3.1 (12)".
bool is_number(const std::string& cell) {
  constexpr std::size_t longest = 16;
  const std::size_t first = cell.starts_with('-') ? 1 : 0;
  return cell == no_value || (first < cell.size() && cell.size() <= longest &&
                              std::isdigit(static_cast<unsigned char>(cell[first])) != 0);
}

}  // namespace

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

std::vector<bool> number_columns(const Table& table) {
  std::vector<bool> numbers(table.header.size(), !table.rows.empty());
  for (const auto& row : table.rows)
    for (std::size_t column = 0; column < row.size() && column < numbers.size(); ++column)
      numbers[column] = numbers[column] && (is_number(row[column]) || row[column] == no_result);
  return numbers;
}

}  // namespace thermorig::report
