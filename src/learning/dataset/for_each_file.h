// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <functional>

#include "thermorig/learning/dataset/dataset.h"

namespace thermorig::dataset {

/// Calls `work` with 0 to `count` - 1, in order, on all cores. Throws what it threw for the first of the
/// files.
void for_each_file(std::size_t count, const std::function<void(std::size_t)>& work,
                   const ReadingProgress& progress);

}  // namespace thermorig::dataset
