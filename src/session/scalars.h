// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>

#include "thermorig/session/session.h"

namespace thermorig::session {

inline constexpr const char* format_name = "thermorig-session";
inline constexpr const char* format_version = "1.0.0";
inline constexpr const char* format_major = "1.";

std::string name_of(State state);

/// CRC-32 of the values that stand in attributes alone, which HDF5 does not protect:
/// root attribute `scalars_crc32`.
std::uint32_t scalars_crc32(const Session& session);

/// "2026-07-25T14:35:12.000001Z" and so many seconds later; empty if `start` is not of this form.
std::string utc_after(const std::string& start, double seconds);

}  // namespace thermorig::session
