// SPDX-License-Identifier: MIT
#pragma once

#include <stdexcept>
#include <string>

namespace thermorig {

/// Exit codes of the program: documented in README.md and docs/commands.md. Scripts rely on them.
enum class ExitCode : int {
  ok = 0,
  failed = 1,
  bad_usage = 2,       // bad arguments, plan or configuration
  finished_lossy = 3,  // finished, but data were lost or too many samples are invalid
  device_missing = 4,  // device missing or not identified
  device_lost = 5,     // device failed during the run
  no_permission = 6,   // not allowed to open the port or another program holds it
  storage = 7,         // full, read-only, I/O error
  not_a_session = 8,   // not a session, journal or model, or damaged
  check_failed = 9,    // `inspect --check`: the verdict is "bad", or attributes were changed
  interrupted = 130,   // stopped by Ctrl-C after a clean close
};

/// The world refuses: what happened, where, and what to try. Caught once, in `app`.
/// Noise on the line is never an Error: it is a counter.
class Error : public std::runtime_error {
 public:
  Error(ExitCode code, std::string what, std::string where, std::string advice);

  ExitCode code() const { return code_; }
  const std::string& what_happened() const { return what_; }
  const std::string& where() const { return where_; }
  const std::string& advice() const { return advice_; }

 private:
  ExitCode code_;
  std::string what_;
  std::string where_;
  std::string advice_;
};

}  // namespace thermorig
