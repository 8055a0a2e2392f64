// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

namespace thermorig::session {

/// From here on this process can open, make and send nothing but through what it has open; it ends by a
/// signal when it takes more memory or time than a sound session of so many bytes needs, and leaves no core
/// file.
void enter_cage(std::uint64_t session_bytes);

}  // namespace thermorig::session
