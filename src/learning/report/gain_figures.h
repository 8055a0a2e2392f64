// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "thermorig/learning/study/evaluation.h"

namespace thermorig::report {

/// "collapsed to 0", "collapsed to 1" (study::collapsed) or "open"; no value where there is no gate.
std::string gate_text(const study::GainStatistics& gain);
/// Middle of the fullest bin.
double peak_of(const study::GainStatistics& gain);

}  // namespace thermorig::report
