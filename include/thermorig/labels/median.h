// SPDX-License-Identifier: MIT
#pragma once

#include "thermorig/core/statistics.h"

namespace thermorig::labels {

using thermorig::median;

}  // namespace thermorig::labels
