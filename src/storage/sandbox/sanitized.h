// SPDX-License-Identifier: MIT
#pragma once

namespace thermorig::sandbox {

/// Whether this was built with a sanitizer that needs more than the program: terabytes of addresses, and a
/// pipe by which it asks whether an object can be read.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define THERMORIG_IS_SANITIZED
#elif defined(__has_feature)  // Clang's way of telling
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define THERMORIG_IS_SANITIZED
#endif
#endif
#if defined(THERMORIG_IS_SANITIZED)
inline constexpr bool is_sanitized = true;
#else
inline constexpr bool is_sanitized = false;
#endif

}  // namespace thermorig::sandbox
