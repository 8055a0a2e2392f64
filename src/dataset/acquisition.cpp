// SPDX-License-Identifier: MIT
#include "thermorig/dataset/dataset.h"
