// SPDX-License-Identifier: MIT
#pragma once

#include <unistd.h>

/// Of the coverage build, which asks the linker for it; elsewhere there is none.
extern "C" [[gnu::weak]] void __gcov_dump();

namespace thermorig::session {

/// Ends a child that a test forked, without what the test registered for its own end. Which lines it has run
/// counts as well.
[[noreturn]] inline void leave(int code) {
  if (__gcov_dump != nullptr) __gcov_dump();
  ::_exit(code);
}

}  // namespace thermorig::session
