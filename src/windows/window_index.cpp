// SPDX-License-Identifier: MIT
#include "thermorig/windows/window_index.h"
