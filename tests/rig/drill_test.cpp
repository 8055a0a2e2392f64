// SPDX-License-Identifier: MIT
// Cables pulled, a host that freezes, a program that is killed: the servo comes to rest, nothing that was
// read is lost, and somebody says what to do.
#include <gmock/gmock.h>

#include "drill.h"

namespace thermorig::tests {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;

const std::vector<std::string> live{"live",           "--record",          "--no-page",
                                    "--no-preflight", "--replug-patience", "0"};
const std::vector<std::string> record{"record", "--no-preflight", "--replug-patience", "0"};

constexpr int long_leg = 40;  // frames: no leg ends before the mishap

bool has_event(const session::Session& session, EventKind kind) {
  return std::any_of(session.raw.events.begin(), session.raw.events.end(),
                     [&](const RecordingEvent& event) { return event.kind == kind; });
}

class RecordDrill : public Drill {};

TEST_F(RecordDrill, OfAServoThatIsUnpluggedEndsAtRestWithAllThatWasRead) {
  const Outcome outcome = suffer(record, Mishap::servo_unplugged, long_leg);
  EXPECT_EQ(outcome.code, 5) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.out + outcome.err, HasSubstr("check cable and power"));
  expect_rest(Mishap::servo_unplugged);
  expect_rest_at_once();
  expect_complete(only_session());
}

class LiveDrill : public Drill {};

TEST_F(LiveDrill, GoesOnWithoutTheCamera) {
  const Outcome outcome = suffer(live, Mishap::camera_unplugged, 12);
  EXPECT_EQ(outcome.code, 3) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("without the camera"));
  EXPECT_THAT(outcome.out, HasSubstr("check cable and power"));
  expect_rest(Mishap::camera_unplugged);
  const session::Session session = only_session();
  expect_complete(session);
  EXPECT_TRUE(has_event(session, EventKind::missing));
  EXPECT_TRUE(has_event(session, EventKind::finished));
  EXPECT_GT(session.raw.estimates.size(),
            session.frames.size());  // rows stand in for the frames that never came
}

TEST_F(LiveDrill, GoesOnWithoutTheGyro) {
  const Outcome outcome = suffer(live, Mishap::gyro_unplugged, 12);
  EXPECT_EQ(outcome.code, 3) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("without the gyro"));
  expect_rest(Mishap::gyro_unplugged);
  const session::Session session = only_session();
  expect_complete(session);
  EXPECT_EQ(session.raw.estimates.size(), session.frames.size());
}

TEST_F(LiveDrill, OfAFrozenHostStopsTheServoByItsWatchdogAndGoesOn) {
  const Outcome outcome = suffer(live, Mishap::host_frozen, 12);
  EXPECT_THAT(outcome.code, AnyOf(0, 3)) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("watchdog"));
  expect_rest(Mishap::host_frozen);
  EXPECT_TRUE(has_event(only_session(), EventKind::finished));
}

TEST_F(LiveDrill, OfAKilledProgramStopsTheServoAndRecoversTheRows) {
  suffer(live, Mishap::program_killed, long_leg);
  expect_rest(Mishap::program_killed);
  ASSERT_TRUE(files(".h5").empty());
  const Outcome recovered = run("recover recordings");
  EXPECT_THAT(recovered.code, AnyOf(0, 3)) << recovered.err;
  const session::Session session = only_session();
  expect_complete(session);
  EXPECT_GT(session.raw.estimates.size(), 0U);
}

}  // namespace
}  // namespace thermorig::tests
