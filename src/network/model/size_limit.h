// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

namespace thermorig::model {

/// The largest network has 751,000 weights, 3 MB; somebody else's exporter may add text. Larger files are
/// refused before they are read: a field of two bytes may become a message of 150 in memory.
inline constexpr std::size_t file_bytes_max = std::size_t{8} << 20U;

}  // namespace thermorig::model
