// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "clock_fits.h"
#include "thermorig/core/sample.h"

namespace thermorig::pipeline {

/// One piece of a device's stream between two of its absences, and the clock fitted to it.
struct ClockPiece {
  ClockFit fit;
  std::vector<Stamp> causal;  // of its messages: they stand where too little came for a fit
};

/// One clock of all pieces, which have nothing to do with each other: each begins a new epoch, with a gap
/// before it. Figures of the report are means over the messages, the largest ones the largest of all.
/// `device`: its name, for the reasons.
ClockFit joined(std::vector<ClockPiece> pieces, const std::string& device, double nominal_rate_hz);

}  // namespace thermorig::pipeline
