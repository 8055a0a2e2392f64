// SPDX-License-Identifier: MIT
#pragma once

#include "thermorig/core/time.h"

namespace thermorig {

/// So many seconds after the origin of the host's clock.
inline HostTime at_s(double seconds) {
  return HostTime(from_s(seconds));
}

}  // namespace thermorig
