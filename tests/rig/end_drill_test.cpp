// SPDX-License-Identifier: MIT
// However the program ends, the servo comes to rest, and it never left its limits. Ends of other kinds:
// last_words_test.cpp and servo_rest_test.cpp, in virtual time.
#include <gmock/gmock.h>

#include "drill.h"

namespace thermorig::tests {
namespace {

constexpr int leg_to_the_mishap = 40;  // frames: no leg ends before the mishap

struct End {
  Mishap mishap;
  bool live = false;
};

class EndDrill : public Drill, public testing::WithParamInterface<End> {
 protected:
  std::vector<std::string> command() const {
    if (GetParam().live) return {"live", "--record", "--no-page"};
    return {"record", "--no-preflight"};
  }
};

constexpr End ends[] = {{Mishap::interrupted},
                        {Mishap::hung_up, true},
                        {Mishap::quit},
                        {Mishap::program_killed},
                        {Mishap::disk_full}};

INSTANTIATE_TEST_SUITE_P(Ends, EndDrill, testing::ValuesIn(ends), [](const auto& end) {
  return (end.param.live ? "Live" : "Record") + name_of(end.param.mishap);
});

TEST_P(EndDrill, LeavesTheServoAtRest) {
  const Outcome outcome = suffer(command(), GetParam().mishap, leg_to_the_mishap);
  EXPECT_NE(outcome.code, 0) << outcome.out << outcome.err;
  expect_rest_after_the_end();
  expect_within_limits();
}

}  // namespace
}  // namespace thermorig::tests
