// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "thermorig/storage/session/session.h"

namespace thermorig::app {

/// What times and labels of a session rest on, and what would make them better. No verdict of its own: there
/// is one only, session::Quality's.
struct TimingRemarks {
  std::vector<std::string> sentences;
  std::vector<std::string> advice;  // what to type or to do, in the order in which it helps
};
TimingRemarks timing_remarks(const session::Session& session);

/// False: the file was made before clocks were fitted, and has to be reprocessed.
bool has_timing(const session::Session& session);

}  // namespace thermorig::app
