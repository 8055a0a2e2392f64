// SPDX-License-Identifier: MIT
#pragma once

#include "columns.h"
#include "thermorig/storage/session/rows.h"

namespace thermorig::view {

/// What the estimate of a frame says where there is none.
inline constexpr std::uint8_t no_estimate = 255;

/// A row for every n-th frame: its time, its speeds, its validity, and what the estimators of a live run said
/// of it. docs/session_page.md has the list.
Columns frame_columns(const session::Rows& rows, std::size_t every);

}  // namespace thermorig::view
