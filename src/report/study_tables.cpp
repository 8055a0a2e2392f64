// SPDX-License-Identifier: MIT
#include "thermorig/report/report.h"
