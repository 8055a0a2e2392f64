// SPDX-License-Identifier: MIT
#include "thermorig/model/model.h"
