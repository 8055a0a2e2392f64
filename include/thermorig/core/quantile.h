// SPDX-License-Identifier: MIT
#pragma once

#include "thermorig/core/statistics.h"
