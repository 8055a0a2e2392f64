// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "thermorig/study/evaluation.h"

namespace thermorig::study {

constexpr std::size_t index_of(Estimator estimator) {
  return static_cast<std::size_t>(estimator);
}

/// What an estimator says of a window, deg/s; NaN where it says nothing.
double speed_of(const training::WindowEstimate& estimate, Estimator estimator,
                std::span<const windows::Acquisition> acquisitions, bool fusion);

}  // namespace thermorig::study
