// SPDX-License-Identifier: MIT
// However the program ends, the servo comes to rest, and it never left its limits.
#include <gmock/gmock.h>

#include "drill.h"

namespace thermorig::tests {
namespace {

constexpr int long_leg = 40;  // frames: no leg ends before the mishap

struct End {
  Mishap mishap;
  bool live = false;
};

class EndDrill : public Drill, public testing::WithParamInterface<End> {
 protected:
  std::vector<std::string> command() const {
    if (GetParam().live) return {"live", "--record", "--no-page"};
    return {"record", "--no-gate"};
  }
};

std::vector<End> ends() {
  std::vector<End> all;
  for (const Mishap mishap : {Mishap::interrupted, Mishap::terminated, Mishap::hung_up, Mishap::quit,
                              Mishap::aborted, Mishap::program_killed, Mishap::disk_full})
    all.push_back({mishap});
  for (const Mishap mishap : {Mishap::interrupted, Mishap::hung_up, Mishap::disk_full})
    all.push_back({mishap, true});
#ifdef THERMORIG_MISHAP_IS_BUILT
  for (const Mishap mishap : {Mishap::exception_thrown, Mishap::terminate_called, Mishap::null_dereferenced,
                              Mishap::stack_overflown, Mishap::memory_gone})
    all.push_back({mishap});
#endif
  return all;
}

INSTANTIATE_TEST_SUITE_P(Ends, EndDrill, testing::ValuesIn(ends()), [](const auto& end) {
  return (end.param.live ? "Live" : "Record") + name_of(end.param.mishap);
});

TEST_P(EndDrill, LeavesTheServoAtRest) {
  const Outcome outcome = suffer(command(), GetParam().mishap, long_leg);
  EXPECT_NE(outcome.code, 0) << outcome.out << outcome.err;
  expect_rest_after_the_end();
  expect_within_limits();
}

class NoiseDrill : public Drill {};

TEST_F(NoiseDrill, OnTheServosLineNeverLeadsBeyondItsLimits) {
  suffer({"record", "--no-gate"}, Mishap::line_noisy, 6);
  expect_within_limits();
}

}  // namespace
}  // namespace thermorig::tests
