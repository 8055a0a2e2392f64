// SPDX-License-Identifier: MIT
#pragma once

#include "thermorig/core/time.h"

namespace thermorig::live {

/// Any two times may stand in a file: their difference is taken where it cannot overflow. Of times that a
/// clock gave, to less than a nanosecond over months.
inline double seconds_between(HostTime begin, HostTime end) {
  return (static_cast<double>(to_ns(end)) - static_cast<double>(to_ns(begin))) * 1e-9;
}

}  // namespace thermorig::live
