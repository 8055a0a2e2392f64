// SPDX-License-Identifier: MIT
// Recordings in virtual time by the built program: the same seed gives the same bytes, and Table I its
// counts.
#include <gmock/gmock.h>

#include <numeric>

#include "app/program.h"
#include "support/other_program.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::tests {
namespace {

using ::testing::HasSubstr;

class VirtualTime : public ProgramTest {
 protected:
  std::string recorded(int seed, const std::string& environment, const std::string& output) const {
    const Outcome outcome = run("record --fast --json --world honest --simulated=" + std::to_string(seed) +
                                " --environment " + environment + " --output " + output + " " + brief_plan);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return folder() / outcome.lines().back().value("session", "");
  }
};

TEST_F(VirtualTime, GivesEqualBytesInEveryDatasetForEqualSeeds) {
  if (!python_has("h5py")) GTEST_SKIP() << "needs /usr/bin/python3 with h5py: apt-get install python3-h5py";
  const std::string first = recorded(5, "kitchen", "first");
  const Printed same =
      run_script("acceptance/compare_sessions.py " + first + " " + recorded(5, "kitchen", "second"));
  EXPECT_EQ(same.code, 0) << same.text;
  const Printed other =
      run_script("acceptance/compare_sessions.py " + first + " " + recorded(6, "kitchen", "third"));
  EXPECT_EQ(other.code, 1);
  for (const char* name : {"raw/camera/bytes", "raw/gyro/bytes", "raw/servo/arrival_ns", "camera/temperature",
                           "samples/rate_gyro", "@simulation_seed"})
    EXPECT_THAT(other.text, HasSubstr(name));
  const Printed elsewhere =
      run_script("acceptance/compare_sessions.py " + first + " " + recorded(5, "dining", "fourth"));
  EXPECT_THAT(elsewhere.text, HasSubstr("camera/temperature"));
  EXPECT_THAT(elsewhere.text, ::testing::Not(HasSubstr("gyro/counts")));  // the room, not the gyro
}

/// A rig whose gyro is a flight controller, in each of its messages; 115200 baud do not carry 200 HIGHRES_IMU
/// a second.
TEST_F(VirtualTime, RecordsAFlightControllerAsAnyGyro) {
  for (const std::string setting : {"message = 26", "message = 105", "raw_scale_dps = 0.05"}) {
    SCOPED_TRACE(setting);
    const std::string profile =
        "[gyro]\nbaud = 460800\nprotocol = \"mavlink\"\n[gyro.mavlink]\n" + setting + "\n";
    write("mavlink.toml", {reinterpret_cast<const std::uint8_t*>(profile.data()), profile.size()});
    const Outcome outcome =
        run("record --fast --json --world honest --simulated=5 --environment kitchen --rig mavlink.toml " +
            brief_plan);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const auto summary = outcome.lines().back();
    EXPECT_EQ(summary["verdict"], "good");
    const auto session = session::read_session(folder() / summary.value("session", ""));
    EXPECT_EQ(session.raw.header.profile.gyro.protocol, "mavlink");
    EXPECT_EQ(session.counters[Device::gyro].lost, 0U);
    EXPECT_EQ(session.counters[Device::gyro].bad_checksum, 0U);
    ASSERT_GT(session.gyro.size(), 1000U);
    for (const TimedGyro& sample : session.gyro) ASSERT_TRUE(sample.reading.device_time_us.has_value());
  }
}

/// The paper's Table I: 18 acquisitions, 51,561 frames. Of each speed it has 61 frames indoors and 51 in the
/// garden, up to a frame that falls between two legs. One of each kind; tests/bench/table_one.sh records all
/// 18.
TEST_F(VirtualTime, RecordsAsManyFramesAsTableOneHas) {
  struct Row {
    std::string environment;
    int acquisitions, frames, frames_per_speed;
  };
  const std::vector<Row> table{{"kitchen", 4, 12124, 61}, {"garden", 6, 15193, 51}};
  int seed = 0;
  for (const Row& row : table) {
    SCOPED_TRACE(row.environment);
    const Outcome outcome =
        run("record --fast --json --plan table-one --world honest --simulated=" + std::to_string(++seed) +
            " --environment " + row.environment);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const auto summary = outcome.lines().back();
    EXPECT_EQ(summary["speeds"].size(), 50U);
    EXPECT_LE(summary["speeds_short"], 3);
    EXPECT_EQ(summary["verdict"], "good");
    EXPECT_NEAR(summary["frames_swept"], 50 * row.frames_per_speed, 0.03 * 50 * row.frames_per_speed);
    EXPECT_NEAR(row.acquisitions * summary.value("frames_swept", 0), row.frames, 0.03 * row.frames);
    EXPECT_GT(summary["frames"], summary["frames_swept"]);  // the rests
  }
}

}  // namespace
}  // namespace thermorig::tests
