// SPDX-License-Identifier: MIT
#include "thermorig/embedded/c_source.h"
