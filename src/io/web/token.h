// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

namespace thermorig::web {

/// 128 bits of the system's random numbers as 32 lower-case hexadecimal digits. Throws Error(failed).
std::string make_token();

bool is_token(std::string_view text);

/// Takes as long for a nearly right token as for a wholly wrong one.
bool same_token(std::string_view shown, std::string_view token);

}  // namespace thermorig::web
