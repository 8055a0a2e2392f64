// SPDX-License-Identifier: MIT
#include "void_runs.h"

#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>

#include "stall_probe.h"

namespace thermorig::tests {

namespace {

constexpr int repeated_at_once = 2;

std::string ledger() {
  const char* path = std::getenv("THERMORIG_LEDGER");
  return path != nullptr ? path : "";
}

/// One write of a line: several tests note theirs at a time.
void note(const std::string& line) {
  std::fputs(line.c_str(), stdout);
  std::fflush(stdout);
  if (ledger().empty()) return;
  if (std::FILE* file = std::fopen(ledger().c_str(), "a")) {
    std::fputs(line.c_str(), file);
    std::fclose(file);
  }
}

/// True for the first test that asks in a run of the suite, which begins by removing the file.
bool is_first_to_wait() {
  if (ledger().empty()) return true;
  const int file = open((ledger() + ".waited").c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
  if (file < 0) return false;
  close(file);
  return true;
}

}  // namespace

bool VoidRuns::may_run_again(double stood_still_s) {
  ++runs_;
  char line[256];
  std::snprintf(line, sizeof line, "run %d of %s is void: this computer stood still for %.0f ms\n", runs_,
                test_.c_str(), 1e3 * stood_still_s);
  note(line);
  if (runs_ <= repeated_at_once) return true;
  if (runs_ == repeated_at_once + 1 && is_first_to_wait()) {
    wait_for_a_quiet_machine(stall_s);
    return true;
  }
  char name[128] = "";
  gethostname(name, sizeof name - 1);
  note("the computer " + std::string(name) + " stands still too often to judge " + test_ + ": it fails\n");
  return false;
}

}  // namespace thermorig::tests
