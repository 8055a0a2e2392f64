// SPDX-License-Identifier: MIT
#include "thermorig/study/study.h"
