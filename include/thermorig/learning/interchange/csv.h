// SPDX-License-Identifier: MIT
#pragma once

#include "thermorig/learning/interchange/sink.h"
#include "thermorig/learning/interchange/table.h"

namespace thermorig::interchange {

/// RFC 4180, UTF-8: a header "time [s]", then a line a row. Numbers in the shortest form that reads back as
/// the same; one that is not known is an empty field. Text that a spreadsheet would take for a formula has a
/// leading '. Throws as the sink does.
void write_csv(const Table& table, Sink& sink);

}  // namespace thermorig::interchange
