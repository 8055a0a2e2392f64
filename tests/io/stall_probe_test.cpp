// SPDX-License-Identifier: MIT
#include "support/stall_probe.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>
#include <vector>

#include "support/temporary_ledger.h"
#include "support/void_runs.h"

namespace thermorig::tests {
namespace {

/// Keeps every processor busy, several times over.
class Hog {
 public:
  Hog() {
    for (unsigned i = 0; i < 4 * std::thread::hardware_concurrency(); ++i)
      threads_.emplace_back([this] {
        while (!ends_) {
        }
      });
  }
  ~Hog() {
    ends_ = true;
    for (std::thread& thread : threads_) thread.join();
  }

 private:
  std::atomic<bool> ends_ = false;
  std::vector<std::thread> threads_;
};

TEST(StallProbe, DoesNotTakeAHogOfOursForAComputerThatStandsStill) {
  if (!StallProbe::may_come_first()) GTEST_SKIP() << "the system lets no thread come first (CAP_SYS_NICE)";
  const Hog hog;
  const StallProbe probe;
  std::this_thread::sleep_for(std::chrono::seconds(1));
  EXPECT_LT(probe.worst_s(), stall_s);
}

TEST(VoidRuns, AreRepeatedTwiceAndAllAreInTheLedger) {
  const TemporaryLedger ledger;
  VoidRuns runs("Servo.Rests");
  EXPECT_TRUE(runs.may_run_again(0.1));
  EXPECT_TRUE(runs.may_run_again(0.2));
  EXPECT_EQ(ledger.text(),
            "run 1 of Servo.Rests is void: this computer stood still for 100 ms\n"
            "run 2 of Servo.Rests is void: this computer stood still for 200 ms\n");
}

TEST(VoidRuns, FailTheTestOnceTheSuiteHasWaitedForAQuietComputer) {
  const TemporaryLedger ledger;
  ledger.note_that_the_suite_has_waited();
  VoidRuns runs("Servo.Rests");
  for (int run = 1; run <= 2; ++run) EXPECT_TRUE(runs.may_run_again(0.1));
  EXPECT_FALSE(runs.may_run_again(0.1));
  EXPECT_NE(ledger.text().find("stands still too often to judge Servo.Rests: it fails"), std::string::npos);
}

}  // namespace
}  // namespace thermorig::tests
