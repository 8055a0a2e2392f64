// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "thermorig/storage/session/session.h"

namespace thermorig::interchange {

using Value =
    std::variant<std::uint8_t, std::uint16_t, std::uint32_t, std::int64_t, float, double, std::string>;

/// Of a table: its name as in the session file, and its units (UDUNITS; empty for counts, flags and text).
struct Column {
  std::string name;
  std::string units;
  std::size_t type = 0;                      // index into the alternatives of Value
  std::function<Value(std::size_t row)> at;  // refers to the session
};

/// Rows of a session, made one at a time.
struct Table {
  std::size_t rows = 0;
  std::vector<Column> columns;
};

/// `samples`, `camera`, `gyro`, `servo`, `estimates` (of a live run; else without rows), `events`.
const std::vector<std::string>& table_names();

/// Do the times of a recording lie within 64 bits of nanoseconds of Unix time, 1970 to 2262, as TUM and MCAP
/// have them? A computer without a clock of its own may say anything.
bool has_unix_times(const RawRecording& raw);

/// One of table_names(); it refers to `session`, which has a sample a frame, in order.
Table table_of(const session::Session& session, std::string_view name);

}  // namespace thermorig::interchange
