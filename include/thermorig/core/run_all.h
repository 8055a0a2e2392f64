// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <functional>

namespace thermorig {

/// Calls `work(0)` .. `work(count - 1)`, each once, perhaps several at the same time, and returns when all
/// are done; throws what one of them threw. Pure modules start no thread: whoever has some hands them in as
/// this.
using RunAll = std::function<void(std::size_t count, const std::function<void(std::size_t)>& work)>;

/// Of several failures, what the one with the lowest number threw; those after it may not have been called.
/// The calling thread takes part, and the others have ended when it returns.
void on_all_cores(std::size_t count, const std::function<void(std::size_t)>& work);

/// On the calling thread.
inline void in_turn(std::size_t count, const std::function<void(std::size_t)>& work) {
  for (std::size_t i = 0; i < count; ++i) work(i);
}

}  // namespace thermorig
