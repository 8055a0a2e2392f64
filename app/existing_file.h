// SPDX-License-Identifier: MIT
#pragma once

#include "thermorig/io/files/existing.h"

namespace thermorig::app {

using files::require_existing;

}  // namespace thermorig::app
