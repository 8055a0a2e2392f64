// SPDX-License-Identifier: MIT
#include "thermorig/core/sample.h"

#include <bit>

namespace thermorig {

std::uint8_t LabelledSample::first_reason() const {
  return reason_bits == 0 ? 0 : static_cast<std::uint8_t>(std::countr_zero(reason_bits) + 1);
}

}  // namespace thermorig
