// SPDX-License-Identifier: MIT
#include "thermorig/motion/panorama_fit.h"

namespace thermorig::motion {}
