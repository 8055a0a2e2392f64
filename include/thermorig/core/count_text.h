// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>

namespace thermorig {

/// For people: "12,345".
std::string count_text(std::uint64_t count);

}  // namespace thermorig
