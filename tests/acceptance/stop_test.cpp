// SPDX-License-Identifier: MIT
// Ends that a person chose: signals to a recording on ports.
#include <gmock/gmock.h>

#include <csignal>
#include <fstream>
#include <sstream>

#include "recorder.h"

namespace thermorig::tests {
namespace {

using ::testing::HasSubstr;

constexpr int unfinished_leg = 40;  // frames: none of these tests reaches its end

class Signal : public RecorderOnPorts {
 protected:
  pid_t recording_in_first_leg() {
    const pid_t process = start_recording(unfinished_leg);
    wait_for_first_leg();
    rig_.let_pass(300'000);
    return process;
  }

  std::string output_so_far() const {
    std::ostringstream text;
    text << std::ifstream(folder() / "background_out.txt").rdbuf();
    return text.str();
  }

  void expect_partial(const session::Session& session) {
    EXPECT_EQ(session.state, session::State::partial);
    EXPECT_TRUE(session.raw.complete);  // closed by the recorder
    EXPECT_FALSE(messages_of(session.raw, EventKind::stopped).empty());
    ASSERT_FALSE(session.servo.empty());
    EXPECT_EQ(session.servo.back().state.motion, ServoMotion::disarmed);
    for (const Device device : all_devices) {
      const Extent extent = extent_of(device, session);
      EXPECT_EQ(extent.size, read_from(device).value_or(read_ledger_port{extent.size, 0}).bytes)
          << name_of(device);
    }
  }
};

TEST_F(Signal, ToTerminateStopsTheServoAndClosesTheSession) {
  const pid_t process = recording_in_first_leg();
  kill(process, SIGTERM);
  const Outcome outcome = wait(process);
  rig_.ports().stop();
  EXPECT_EQ(outcome.code, 130) << outcome.out << outcome.err;
  EXPECT_TRUE(files(".journal").empty());
  expect_partial(only_session());
}

TEST_F(Signal, TwiceLeavesAJournalThatBecomesASession) {
  const pid_t process = recording_in_first_leg();
  kill(process, SIGINT);
  wait_until([this] { return output_so_far().find("stopping the servo") != std::string::npos; });
  kill(process, SIGINT);
  const Outcome outcome = wait(process);
  rig_.ports().stop();
  EXPECT_EQ(outcome.code, 130) << outcome.out << outcome.err;
  ASSERT_TRUE(files(".h5").empty());
  EXPECT_THAT(outcome.out + outcome.err,
              HasSubstr("thermorig recover " + std::filesystem::relative(only_journal(), folder()).string()));
  EXPECT_EQ(run("recover recordings").code, 0);
  EXPECT_TRUE(files(".journal").empty());
  expect_partial(only_session());
}

}  // namespace
}  // namespace thermorig::tests
