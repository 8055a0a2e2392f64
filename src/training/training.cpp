// SPDX-License-Identifier: MIT
#include "thermorig/training/training.h"
