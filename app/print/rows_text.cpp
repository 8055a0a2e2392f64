// SPDX-License-Identifier: MIT
#include "print/rows_text.h"

#include <fmt/format.h>

#include <string_view>

namespace thermorig::app {

namespace {

constexpr std::string_view rows_begin = "camera rows: ";

}  // namespace

std::string rows_text(const odometer::FoundRows& rows) {
  constexpr double least = odometer::FoundRows::least_margin;
  return fmt::format("{}{}, margin {:.0f} (difference of log-likelihoods){}", rows_begin,
                     odometer::name_of(rows.order), rows.margin,
                     rows.margin < least ? fmt::format(": assumed (limit {:.0f})", least) : "");
}

std::string rows_told(std::span<const RecordingEvent> events) {
  std::string told;
  for (const RecordingEvent& event : events)
    if (event.kind == EventKind::info && event.message.starts_with(rows_begin))
      told = event.message.substr(rows_begin.size());
  return told;
}

}  // namespace thermorig::app
