// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "thermorig/core/error.h"

namespace thermorig::doctor {

/// One thing that was looked at, and what came of it.
struct Check {
  std::string name;
  ExitCode code = ExitCode::ok;
  std::string result;    // the figures, or what is wrong
  std::string advice;    // what to try; empty if nothing need be done
  bool warning = false;  // a recording works, but not as well as it could

  bool failed() const { return code != ExitCode::ok; }
  /// "ok", "warning" or "NOT OK".
  std::string grade() const { return failed() ? "NOT OK" : warning ? "warning" : "ok"; }
};

/// Of the first check that failed; ok if none did, warnings or not.
ExitCode exit_code_of(const std::vector<Check>& checks);

}  // namespace thermorig::doctor
