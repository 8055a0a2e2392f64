// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include <csignal>
#include <fstream>
#include <thread>

#include "program.h"

namespace thermorig::tests {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const std::string fast = "record --simulated=3 --fast --environment garden ";

class Record : public ProgramTest {
 protected:
  void expect_refused(const std::string& arguments, int code, const std::string& sentence) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, code) << arguments << "\n" << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(sentence)) << arguments;
    EXPECT_THAT(outcome.err, HasSubstr("try: ")) << arguments;
    EXPECT_TRUE(files(".h5").empty()) << arguments;
    EXPECT_TRUE(files(".journal").empty()) << arguments;
  }
};

TEST_F(Record, WritesASessionAndSaysWhatToTypeNext) {
  const Outcome outcome = run(fast + brief_plan);
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto sessions = files(".h5");
  ASSERT_EQ(sessions.size(), 1U);
  EXPECT_THAT(sessions[0].string(), HasSubstr("recordings/garden/garden_acq-01_"));
  EXPECT_TRUE(files(".journal").empty());
  EXPECT_THAT(outcome.out, HasSubstr("SIMULATED rig, seed 3"));
  EXPECT_THAT(outcome.out, HasSubstr("next  thermorig inspect recordings/garden/garden_acq-01_"));
  EXPECT_THAT(outcome.out, Not(HasSubstr("\x1b")));
  EXPECT_EQ(outcome.err, "");
}

TEST_F(Record, GivesEventsAsJsonLinesWithTheSummaryLast) {
  const Outcome outcome = run(fast + "--json " + brief_plan);
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto lines = outcome.lines();
  ASSERT_GE(lines.size(), 2U);
  for (const auto& line : lines) EXPECT_TRUE(line.contains("event")) << line;
  EXPECT_EQ(lines.front()["event"], "start");
  EXPECT_EQ(lines.front()["legs"], 4);
  const auto& summary = lines.back();
  EXPECT_EQ(summary["event"], "summary");
  EXPECT_EQ(summary["exit_code"], 0);
  EXPECT_GE(summary["frames_swept"], 48);
  EXPECT_LE(summary["frames_swept"], 56);  // a leg also holds the frames in its ramps
  EXPECT_GT(summary["frames_valid"], 20);
  EXPECT_EQ(summary["speeds_short"], 0);
}

TEST_F(Record, NeverUsesANumberTwice) {
  const auto first = record_briefly();
  std::filesystem::rename(first, first.parent_path() / "garden_acq-07_20200101T000000Z.h5");
  EXPECT_THAT(record_briefly().string(), HasSubstr("garden_acq-08_"));
}

TEST_F(Record, ShowsThePlanAndMovesNothingOnADryRun) {
  const Outcome outcome = run(fast + "--dry-run " + brief_plan);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("4 legs of 12 frames"));
  EXPECT_THAT(outcome.out, HasSubstr("+40.0"));
  EXPECT_THAT(outcome.out, HasSubstr("-80.0"));
  EXPECT_THAT(outcome.out, HasSubstr("camera link"));
  EXPECT_FALSE(std::filesystem::exists(folder() / "recordings"));
}

TEST_F(Record, GivesTheDryRunAsJson) {
  const Outcome outcome = run(fast + "--dry-run --json " + brief_plan);
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto lines = outcome.lines();
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0]["legs_dps"].size(), 4U);
  EXPECT_GT(lines[0]["duration_s"], 6.0);
  for (const auto& check : lines[0]["checks"]) EXPECT_EQ(check["ok"], true) << check;
}

TEST_F(Record, RefusesAnEnvironmentWithASlash) {
  expect_refused("record --simulated --fast --environment a/b", 2, "a/b");
  expect_refused("record --simulated --fast --environment ../x", 2, "../x");
}

TEST_F(Record, ShowsTheSumWhenTheCameraCannotSendSoMuch) {
  expect_refused(fast + "--camera-baud 115200 --camera-rate 8", 2, "115");
  const Outcome outcome = run(fast + "--camera-baud 115200 --camera-rate 8");
  EXPECT_THAT(outcome.err, HasSubstr("1544"));
  EXPECT_THAT(outcome.err, HasSubstr("134.0 ms > 125.0 ms"));
}

TEST_F(Record, ReportsAFailedCheckOfADryRunInItsExitCode) {
  const Outcome outcome = run(fast + "--dry-run --camera-baud 115200 --camera-rate 8");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.out, HasSubstr("NOT OK"));
}

TEST_F(Record, RefusesSpeedsBeyondTheServosLimits) {
  expect_refused(fast + "--speeds 30,900", 2, "900");
}

TEST_F(Record, RefusesLegsTooShortForAnyValidFrame) {
  expect_refused(fast + "--frames-per-leg 1", 2, "leg");
}

TEST_F(Record, RefusesAPlanThatIsNotThere) {
  expect_refused(fast + "--plan nowhere.toml", 2, "nowhere.toml");
}

TEST_F(Record, RefusesAnOutputFolderThatCannotBeWritten) {
  write("taken", {});
  expect_refused(fast + "--output taken " + brief_plan, 7, "taken");
  expect_refused(fast + "--output /proc/recordings " + brief_plan, 7, "/proc/recordings");
  EXPECT_EQ(run(fast + "--output taken " + brief_plan).out, "");
}

TEST_F(Record, RefusesVirtualTimeOnRealPorts) {
  expect_refused("record --fast --environment garden --camera a --gyro b --servo c", 2, "--fast");
}

TEST_F(Record, RefusesContradictingWords) {
  expect_refused("record --simulated --camera /dev/null --environment garden", 2, "exclude each other");
  expect_refused("record --environment garden --simulated-servo 180 --camera a --gyro b --servo c", 2,
                 "--simulated");
  expect_refused("record --environment garden", 2, "no port is named for camera, gyro, servo");
  expect_refused("record --environment garden --rig nowhere.toml", 2, "nowhere.toml");
}

TEST_F(Record, SaysWhichPortDoesNotExist) {
  expect_refused(
      "record --environment garden --plan quick --camera /dev/ttyUSB97 --gyro /dev/ttyUSB98 --servo "
      "/dev/ttyUSB99",
      4, "/dev/ttyUSB97");
}

TEST_F(Record, ClosesTheFileOnCtrlC) {
  const pid_t process = start({"record", "--simulated=3", "--fast", "--environment", "garden", "--json"});
  while (files(".journal").empty() || std::filesystem::file_size(files(".journal")[0]) < 4096)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  kill(process, SIGINT);
  const Outcome outcome = wait(process);
  EXPECT_EQ(outcome.code, 130) << outcome.err;
  EXPECT_EQ(files(".h5").size(), 1U);
  EXPECT_TRUE(files(".journal").empty());
}

TEST_F(Record, DrawsOverItsStatusOnATerminalOnlyAndNotIfNoColourIsWanted) {
  const Outcome plain = run_on_terminal("TERM=xterm NO_COLOR=1", fast + brief_plan);
  const Outcome drawn = run_on_terminal("TERM=xterm", fast + brief_plan);
  ASSERT_EQ(drawn.code, 0) << drawn.out;
  EXPECT_THAT(drawn.out, HasSubstr("\x1b["));
  EXPECT_THAT(drawn.out, HasSubstr("camera  "));
  ASSERT_EQ(plain.code, 0) << plain.out;
  EXPECT_THAT(plain.out, Not(HasSubstr("\x1b")));
}

TEST_F(Record, SimulatesEveryKindOfServo) {
  for (const char* servo : {"180", "270", "continuous"}) {
    const Outcome outcome = run(fast + "--json --simulated-servo " + servo + " " + brief_plan);
    ASSERT_EQ(outcome.code, 0) << servo << outcome.err << outcome.out;
    EXPECT_GE(outcome.lines().back()["frames_swept"], 48) << servo;
    EXPECT_GT(outcome.lines().back()["frames_valid"], 10) << servo;
  }
}

}  // namespace
}  // namespace thermorig::tests
