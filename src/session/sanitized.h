// SPDX-License-Identifier: MIT
#pragma once

namespace thermorig::session {

/// Whether this was built with a sanitizer that needs more than the program: terabytes of addresses, and a
/// pipe by which it asks whether an object can be read.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool is_sanitized = true;
#else
inline constexpr bool is_sanitized = false;
#endif

}  // namespace thermorig::session
