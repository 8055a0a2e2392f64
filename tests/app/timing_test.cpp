// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "program.h"
#include "session/replace_session.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::tests {
namespace {

using ::testing::HasSubstr;

class Timing : public ProgramTest {};

TEST_F(Timing, TellsOfClocksBoundsOffsetsAndResiduals) {
  const auto session = record_briefly();
  const Outcome outcome = run("inspect --timing " + session.string());
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  for (const char* part :
       {"SIMULATED", "one-way", "two-way", "late p50", "delay < 2.00 ms", "proof", "camera - gyro",
        "gyro bias", "gyro scale", "assumed", "servo scale", "verdict", "thermorig calibrate scale"})
    EXPECT_THAT(outcome.out, HasSubstr(part));
}

TEST_F(Timing, FitsIntoAHundredColumns) {
  record_briefly();
  const Outcome outcome = run("inspect --timing recordings/garden/*.h5");
  std::istringstream lines(outcome.out);
  std::size_t longest = 0;
  for (std::string line; std::getline(lines, line);) longest = std::max(longest, line.size());
  EXPECT_GT(longest, 60U);
  EXPECT_LE(longest, 100U);
}

TEST_F(Timing, GivesTheSameAsJson) {
  const auto session = record_briefly();
  const auto plain = run("inspect --json " + session.string()).lines()[0][0];
  EXPECT_FALSE(plain.contains("timing"));
  const auto timing = run("inspect --timing --json " + session.string()).lines()[0][0]["timing"];
  for (const char* device : {"camera", "gyro", "servo"}) {
    const auto& clock = timing["clock"][device];
    EXPECT_GT(clock["rate_hz"], 1.0) << device;
    EXPECT_GT(clock["uncertainty_us"], 0.0) << device;
    EXPECT_GT(clock["bound_max_us"], clock["uncertainty_us"]) << device;
    EXPECT_EQ(clock["gaps"].size(), 0U) << device;
  }
  EXPECT_EQ(timing["clock"]["gyro"]["method"], "one-way");
  EXPECT_EQ(timing["clock"]["gyro"]["lower_bound_is_proof"], false);
  EXPECT_EQ(timing["clock"]["servo"]["lower_bound_is_proof"], true);
  EXPECT_EQ(timing["gyro"]["scale_calibrated"], false);
  EXPECT_EQ(timing["gyro"]["zeroes_itself"], false);
  EXPECT_EQ(timing["verdict"], plain["verdict"]);
  EXPECT_EQ(timing["verdict_reasons"], plain["verdict_reasons"]);
  EXPECT_GT(timing["servo"]["delay_uncertainty_s"], 0.0);
  EXPECT_GE(timing["servo"]["speeds"].size(), 2U);
}

TEST_F(Timing, StandsInOneLineOfThePlainReport) {
  const Outcome outcome = run("inspect " + record_briefly().string());
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("timing   camera +- "));
}

TEST_F(Timing, ASessionThatKnowsNoClocksAsksToBeReprocessed) {
  const auto path = record_briefly();
  session::Session session = session::read_session(path);
  session.sync = {};
  session::replace_session(path, session);
  for (const char* option : {"", "--timing "}) {
    const Outcome outcome = run("inspect " + std::string(option) + path.string());
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("thermorig reprocess " + path.string())) << option;
  }
  EXPECT_TRUE(run("inspect --timing --json " + path.string()).lines()[0][0]["timing"].is_null());
  ASSERT_EQ(run("reprocess " + path.string()).code, 0);
  EXPECT_THAT(run("inspect " + path.string()).out, HasSubstr("timing   camera +- "));
}

TEST_F(Timing, ListsGapsAndEpochsAndCountsThemAgainstTheSession) {
  const auto path = record_briefly();
  session::Session session = session::read_session(path);
  const HostTime start = session.raw.header.time_reference;
  ClockReport& camera = session.sync.clock[Device::camera];
  for (int i = 0; i < 7; ++i)
    camera.gaps.push_back({.begin = start + from_s(i), .end = start + from_s(i + 0.5), .missing = 3});
  ClockReport& servo = session.sync.clock[Device::servo];
  servo.epochs.resize(1);
  servo.epochs.push_back({.begin = start + from_s(4.25), .reason = "the micro-controller was reset"});
  session.sync.clock[Device::gyro].uncertainty_us = 12'500.0;
  session::replace_session(path, session);
  const Outcome outcome = run("inspect --timing " + path.string());
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  for (const char* part :
       {"camera 4.00 s to 4.50 s, 3 missing", "and 2 more of the camera",
        "servo at 4.25 s: the micro-controller was reset", "the times of the gyro are known to 12.5 ms",
        "verdict       bad", "try           record again "})
    EXPECT_THAT(outcome.out, HasSubstr(part));
  EXPECT_EQ(run("inspect --timing --check " + path.string()).code, 9);
  EXPECT_EQ(run("inspect --check " + path.string()).code, 9);
  const auto clock = run("inspect --timing --json " + path.string()).lines()[0][0]["timing"]["clock"];
  EXPECT_EQ(clock["camera"]["gaps"].size(), 7U);
  EXPECT_NEAR(clock["servo"]["epochs"][1]["begin_s"], 4.25, 1e-6);
}

TEST_F(Timing, AReasonInAFileDoesNotSteerTheTerminal) {
  const auto path = record_briefly();
  session::Session session = session::read_session(path);
  session.sync.clock[Device::servo].epochs = {{}, {.begin = {}, .reason = "\x1b[2Jit was reset"}};
  session::replace_session(path, session);
  for (const char* option : {"", "--timing "}) {
    const Outcome outcome = run("inspect " + std::string(option) + path.string());
    EXPECT_EQ(outcome.out.find('\x1b'), std::string::npos) << option;
    EXPECT_THAT(outcome.out, HasSubstr("it was reset")) << option;
  }
}

TEST_F(Timing, ARestForACalibrationIsJudgedByItsStreams) {
  ASSERT_EQ(run("calibrate bias --world honest --simulated=3 --fast").code, 0);
  const std::string session = files(".h5")[0].string();
  const Outcome outcome = run("inspect --timing --check " + session);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("verdict       good"));
  EXPECT_THAT(outcome.out, HasSubstr("remarks       the camera's delay is assumed"));
}

TEST_F(Timing, ReprocessTouchesNothingIfOneFileIsNone) {
  const auto path = record_briefly();
  const auto written = std::filesystem::last_write_time(folder() / path);
  EXPECT_EQ(run("reprocess " + path.string() + " nonexistent.h5").code, 2);
  std::ofstream(folder() / "notes.h5") << "not ours";
  EXPECT_EQ(run("reprocess " + path.string() + " notes.h5").code, 8);
  EXPECT_EQ(std::filesystem::last_write_time(folder() / path), written);
}

TEST_F(Timing, ReprocessTellsWhatChanged) {
  const auto path = record_briefly();
  const auto same = run("reprocess --json " + path.string()).lines()[0][0];
  EXPECT_EQ(same["moved_max_s"], 0.0);
  EXPECT_EQ(same["before"]["frames_valid"], same["frames_valid"]);
  ASSERT_EQ(run("calibrate latency --world honest --simulated=3 --fast --save bench.toml").code, 0);
  const Outcome outcome = run("reprocess --rig bench.toml " + path.string());
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("times    moved by "));
  EXPECT_THAT(outcome.out, HasSubstr("applied  camera latency of 20"));
  const session::Session after = session::read_session(path);
  EXPECT_NE(after.raw.header.profile.camera.link.latency_measured_utc, "");
  const Outcome missing = run("reprocess --rig missing " + path.string());
  EXPECT_EQ(missing.code, 2);
  EXPECT_THAT(missing.err, HasSubstr("there is no such profile"));
}

}  // namespace
}  // namespace thermorig::tests
