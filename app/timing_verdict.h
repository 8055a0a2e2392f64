// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "thermorig/session/session.h"

namespace thermorig::app {

/// Whether a session's times and labels can be trusted, and what stands against it or would make it better.
struct TimingVerdict {
  std::string word;                  // "good", "usable", "bad"; "unknown" without a report
  std::vector<std::string> reasons;  // against it
  std::vector<std::string> advice;   // commands to type, in the order in which they help
};
TimingVerdict timing_verdict(const session::Session& session);

/// False: the file was made before clocks were fitted, and has to be reprocessed.
bool has_timing(const session::Session& session);

}  // namespace thermorig::app
