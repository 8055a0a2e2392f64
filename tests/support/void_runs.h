// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace thermorig::tests {

/// A run of a test that failed while this computer stood still says nothing: it is void. Notes it in the
/// ledger (the file that THERMORIG_LEDGER names, and standard output), and says whether the test may run
/// again: after its first and its second void run at once. After a third one the suite waits for a quiet
/// computer, once for all its tests; whichever is void beyond that fails, and the ledger names the computer.
class VoidRuns {
 public:
  explicit VoidRuns(std::string test) : test_(std::move(test)) {}
  bool may_run_again(double stood_still_s);

 private:
  std::string test_;
  int runs_ = 0;
};

}  // namespace thermorig::tests
