// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "thermorig/learning/study/study.h"

namespace thermorig::app {

/// The study's medians for the terminal.
std::string study_text(const std::vector<study::JobResult>& results);

}  // namespace thermorig::app
