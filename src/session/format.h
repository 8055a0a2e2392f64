// SPDX-License-Identifier: MIT
#pragma once

namespace thermorig::session {

inline constexpr const char* format_name = "thermorig-session";
inline constexpr const char* licence_not_stated = "not stated";
inline constexpr const char* format_version = "1.3.0";
inline constexpr unsigned format_major = 1;
inline constexpr unsigned format_minor = 3;

}  // namespace thermorig::session
