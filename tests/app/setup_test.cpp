// SPDX-License-Identifier: MIT
// The guided first run by the built program. Its steps: tests/rig/setup_test.cpp, and
// setup_on_ports_test.cpp.
#include <gmock/gmock.h>

#include <cstdlib>

#include "program.h"

namespace thermorig::tests {
namespace {

using ::testing::HasSubstr;

class SetupCommand : public ProgramTest {};

TEST_F(SetupCommand, MovesNothingWhereNobodyCanAnswer) {
  const Outcome outcome = run("setup --simulated=4 --save ./rig.toml </dev/null");
  EXPECT_EQ(outcome.code, 2) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("--yes"));
  EXPECT_FALSE(std::filesystem::exists(folder() / "rig.toml"));
}

TEST_F(SetupCommand, RefusesStepsThatItCannotBeginWith) {
  EXPECT_THAT(run("setup --json /dev/null").err, HasSubstr("--yes"));
  EXPECT_THAT(run("setup --yes --from turn /dev/null").err, HasSubstr("turns"));
  const Outcome missing = run("setup --yes --from turns --save ./rig.toml /dev/null");
  EXPECT_EQ(missing.code, 2) << missing.err;
  EXPECT_THAT(missing.err, HasSubstr("there is no such profile"));
  const Outcome unplugged = run("setup --yes --save ./rig.toml /dev/no-such-port /dev/nor-this");
  EXPECT_EQ(unplugged.code, 4) << unplugged.err;
  EXPECT_THAT(unplugged.err, HasSubstr("none of these ports exists"));
  EXPECT_THAT(unplugged.err, HasSubstr("/dev/no-such-port, /dev/nor-this"));
}

/// Nobody else knows which rig was simulated, and its ports are gone: it is set up from the first step.
TEST_F(SetupCommand, AdvisesTheSameSimulatedRigOnceMore) {
  if (std::getenv("THERMORIG_EVERYTHING") == nullptr) GTEST_SKIP() << "takes 10 s: tests/nightly.sh runs it";
  const Outcome outcome =
      run("setup --simulated=4 --world honest --yes --output /proc/none --save ./rig.toml");
  EXPECT_NE(outcome.code, 0) << outcome.out;
  EXPECT_THAT(outcome.err, HasSubstr("thermorig setup --simulated=4 --world honest --save ./rig.toml\n"));
  EXPECT_FALSE(std::filesystem::exists(folder() / "rig.toml"));
}

}  // namespace
}  // namespace thermorig::tests
