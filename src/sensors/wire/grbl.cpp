// SPDX-License-Identifier: MIT
#include "thermorig/sensors/wire/grbl.h"

#include <fmt/format.h>

#include <charconv>
#include <string>

namespace thermorig::wire::grbl {

namespace {

std::vector<std::uint8_t> bytes_of_line(std::string_view line) {
  return {line.begin(), line.end()};
}

/// Takes `word` off the front of the line, and the number behind it.
template <typename Number>
std::optional<Number> take_number(std::string_view& line, std::string_view word) {
  if (!line.starts_with(word)) return std::nullopt;
  line.remove_prefix(word.size());
  Number value{};
  const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), value);
  if (error != std::errc()) return std::nullopt;
  line.remove_prefix(static_cast<std::size_t>(end - line.data()));
  return value;
}

}  // namespace

std::vector<std::uint8_t> jog_line(const Jog& jog) {
  return bytes_of_line(
      fmt::format("$J=G91X{:.3f}F{:.1f}(leg {})\n", jog.way_deg, 60.0 * jog.rate_dps, jog.leg));
}

std::optional<Jog> parse_jog(std::string_view line) {
  const auto way_deg = take_number<double>(line, "$J=G91X");
  const auto feed = way_deg ? take_number<double>(line, "F") : std::nullopt;
  const auto leg = feed ? take_number<std::uint16_t>(line, "(leg ") : std::nullopt;
  if (!leg || line != ")" || !std::isfinite(*way_deg) || !(*feed >= 0.0) || !std::isfinite(*feed))
    return std::nullopt;
  return Jog{*way_deg, *feed / 60.0, *leg};
}

std::vector<std::uint8_t> power_note(bool is_armed) {
  return bytes_of_line(is_armed ? "(armed)\n" : "(disarmed)\n");
}

std::optional<bool> parse_power_note(std::string_view line) {
  if (line == "(armed)") return true;
  return line == "(disarmed)" ? std::optional(false) : std::nullopt;
}

std::vector<std::uint8_t> settings_request() {
  return bytes_of_line("$$\n");
}

std::optional<Setting> parse_setting(std::string_view line) {
  const auto number = take_number<int>(line, "$");
  if (!number) return std::nullopt;
  const auto value = take_number<double>(line, "=");
  const bool has_end = line.empty() || line.front() == ' ';  // some builds add a remark
  if (!value || !has_end || !std::isfinite(*value)) return std::nullopt;
  return Setting{*number, *value};
}

std::vector<std::uint8_t> unlock() {
  return bytes_of_line("$X\n");
}

}  // namespace thermorig::wire::grbl
