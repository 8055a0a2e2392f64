// SPDX-License-Identifier: MIT
#include "text_columns.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "output.h"

namespace thermorig::app {

namespace {

std::string rate_columns(const TextColumns& columns) {
  return fmt::format("{},{},{}", columns.rate[0], columns.rate[1], columns.rate[2]);
}

std::string quoted(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? "'\\''" : std::string(1, c);
  return quoted + "'";
}

}  // namespace

std::string columns_text(const TextColumns& columns) {
  std::string text = columns.prefix.empty() ? "no prefix" : fmt::format("prefix \"{}\"", columns.prefix);
  text += fmt::format(", columns {} as x,y,z, {:.6g} deg/s a unit", rate_columns(columns), columns.scale_dps);
  if (columns.time >= 0)
    text += fmt::format(", time in column {} ({:g} s a unit)", columns.time, columns.time_unit_s);
  return text;
}

std::string options_text(const TextColumns& columns) {
  std::string text = "--gyro-protocol text";
  if (!columns.prefix.empty()) text += " --prefix " + quoted(columns.prefix);
  text += " --columns " + rate_columns(columns);
  if (columns.scale_dps != 1.0) text += fmt::format(" --scale {:.6g}", columns.scale_dps);
  if (columns.time >= 0)
    text += fmt::format(" --time-column {} --time-unit {:g}", columns.time, columns.time_unit_s);
  return text;
}

std::string assumptions_text(const sensors::TextFormat& format) {
  return fmt::format("{}", fmt::join(format.assumptions, "; "));
}

nlohmann::json format_json(const sensors::TextFormat& format) {
  return {{"sample_line", format.sample_line},
          {"fields", format.fields},
          {"prefix", format.columns.prefix},
          {"columns", format.columns.rate},
          {"scale_dps", format.columns.scale_dps},
          {"time_column", format.columns.time},
          {"time_unit_s", format.columns.time_unit_s},
          {"rates_known", format.rates_known},
          {"scale_known", format.scale_known},
          {"refusal", format.refusal},
          {"question", sensors::open_question(format)},
          {"assumptions", format.assumptions},
          {"sketch", format.sketch},
          {"remarks", format.remarks}};
}

}  // namespace thermorig::app
