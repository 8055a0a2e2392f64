// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "thermorig/session/session.h"

namespace thermorig::dataset {

/// What the gyro showed before anything turned it.
struct OpeningRest {
  double bias_dps = 0.0;  // mean of its samples; NaN if there is none
  std::uint64_t samples = 0;
};

/// Over the time before the first leg in which the servo stood still, and had done so for a second.
OpeningRest opening_rest_of(const session::Session& session);

}  // namespace thermorig::dataset
