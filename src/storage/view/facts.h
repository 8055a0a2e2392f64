// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "columns.h"
#include "thermorig/storage/session/rows.h"

namespace thermorig::view {

/// What stands beside the frames, as one JSON text: where it comes from, plan, verdict, legs, events,
/// annotations, estimators, and the names of the columns. `file`: the session's name.
std::string facts_json(const std::string& file, const session::Rows& rows, const Columns& columns);

}  // namespace thermorig::view
