// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <span>

#include "thermorig/learning/study/evaluation.h"

namespace thermorig::study {

/// Nothing where no window has a bound.
std::optional<BoundErrors> bound_errors(std::span<const JudgedWindow> judged);

}  // namespace thermorig::study
