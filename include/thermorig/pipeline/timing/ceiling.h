// SPDX-License-Identifier: MIT
#pragma once

namespace thermorig::timing {

/// A point that a clock's curve may not exceed, in seconds: `x` on the device's clock, `y` on the host's.
struct Ceiling {
  double x = 0.0;
  double y = 0.0;
};

}  // namespace thermorig::timing
