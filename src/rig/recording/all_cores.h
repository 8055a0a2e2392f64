// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <functional>

namespace thermorig::rig {

/// A RunAll on as many threads as there are cores; they have ended when it returns.
void on_all_cores(std::size_t count, const std::function<void(std::size_t)>& work);

}  // namespace thermorig::rig
