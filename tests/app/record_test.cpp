// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fstream>

#include "program.h"
#include "support/hand_clock.h"
#include "thermorig/rig/sweep/plan.h"
#include "thermorig/sensors/gyro_sketch.h"
#include "thermorig/simulation/virtual_rig.h"

namespace thermorig::tests {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const std::string fast_rig = "record --simulated=3 --fast --environment garden ";
const std::string honest_rig = fast_rig + "--world honest ";

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
  const Outcome outcome = run(honest_rig + brief_plan);
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

/// A sketch's lines between the images are no sign of a bad cable.
TEST_F(Record, TakesACameraWhoseSketchSendsItsImagesAsAnyOther) {
  for (const std::string camera : {"text", "binary"}) {
    const Outcome outcome = run("record --simulated=3 --fast --world honest --simulated-camera " + camera +
                                " --environment " + camera + " " + brief_plan);
    ASSERT_EQ(outcome.code, 0) << camera << outcome.err;
  }
  for (const auto& session : files(".h5")) {
    EXPECT_EQ(run("inspect --check " + session.string()).code, 0) << session;
  }
  EXPECT_EQ(files(".h5").size(), 2U);
}

/// Of each a session that nothing speaks against.
TEST_F(Record, TakesEveryCameraAndGyroThatCanBeSimulated) {
  if (std::getenv("THERMORIG_EVERYTHING") == nullptr) GTEST_SKIP() << "long: tests/nightly.sh runs it";
  std::vector<std::string> words;
  for (const std::string_view camera : simulation::camera_kinds())
    words.push_back("--simulated-camera " + std::string(camera));
  for (const std::string& gyro : sensors::gyro_names()) words.push_back("--simulated-gyro-protocol " + gyro);
  int slow = 0;  // sketches that print once or twice a second, as published: too few valid frames
  for (const std::string& word : words) {
    std::filesystem::remove_all(folder() / "recordings");
    const Outcome outcome = run(honest_rig + word + " --plan quick");
    EXPECT_THAT(outcome.out + outcome.err, Not(HasSubstr("command contradict"))) << word;
    const bool is_slow = outcome.out.find("/s is too low") != std::string::npos;
    EXPECT_TRUE(outcome.code == 0 || (is_slow && outcome.code == 3)) << word << outcome.err;
    EXPECT_TRUE(is_slow || run("inspect --check recordings").code == 0) << word;
    slow += is_slow ? 1 : 0;
  }
  EXPECT_EQ(slow, 3);
}

/// A stick sends each half-frame only when it is asked for one, a bus once it knows the rate.
TEST_F(Record, TakesTheWordsOfARawCamera) {
  for (const std::string camera : {"raw", "i2c"}) {
    const Outcome outcome = run("record --simulated=3 --fast --world honest --simulated-camera " + camera +
                                " --environment " + camera + " " + brief_plan);
    ASSERT_EQ(outcome.code, 0) << camera << outcome.err;
  }
  for (const auto& session : files(".h5")) EXPECT_EQ(run("inspect --check " + session.string()).code, 0);
}

TEST_F(Record, OfABusThatIsNotThereSaysHowToGetOne) {
  const Outcome outcome =
      run("record --environment kitchen --no-servo --camera /dev/i2c-99 --gyro /dev/null");
  EXPECT_EQ(outcome.code, 4);
  EXPECT_THAT(outcome.err, HasSubstr("no such I2C bus"));
  EXPECT_THAT(outcome.err, HasSubstr("raspi-config"));
}

TEST_F(Record, GivesEventsAsJsonLinesWithTheSummaryLast) {
  const Outcome outcome = run(honest_rig + "--json " + brief_plan);
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

TEST_F(Record, SaysWhichSceneStandsForAnEnvironmentThatHasNone) {
  const std::string of_kitchn = "record --world honest --simulated=3 --fast --environment kitchn ";
  const Outcome outcome = run(of_kitchn + brief_plan);
  EXPECT_THAT(outcome.out,
              HasSubstr("SIMULATED rig, seed 3: virtual time, firmware's host build, scene laboratory"));
  EXPECT_THAT(run(of_kitchn + "--scene kitchen " + brief_plan).out,
              HasSubstr(", scene kitchen, world honest\n"));
  EXPECT_THAT(run(honest_rig + brief_plan).out, Not(HasSubstr("scene")));
}

TEST_F(Record, SaysItsWorldAndEachKnobThatIsNotHonest) {
  EXPECT_THAT(run(honest_rig + brief_plan).out, HasSubstr("firmware's host build, world honest\n"));
  const Outcome outcome =
      run(fast_rig + "--world honest,servo.backlash_deg=2,gyro.bandwidth_hz=256 " + brief_plan);
  EXPECT_THAT(outcome.out, HasSubstr("firmware's host build, world honest,servo.backlash_deg=2\n"));
  EXPECT_THAT(run("inspect " + files(".h5").back().string()).out,
              HasSubstr("world honest,servo.backlash_deg=2)"));
}

TEST_F(Record, OfTheTypicalWorldWhichIsTheDefaultCountsItsKnobs) {
  const Outcome outcome = run("record --simulated=4 --fast --environment garden " + brief_plan);
  EXPECT_THAT(outcome.out, testing::ContainsRegex("build, world typical .[0-9]+ knobs.\n"));
  EXPECT_THAT(run("inspect " + files(".h5").back().string()).out, HasSubstr("world typical ("));
  const auto session = run("inspect --json " + files(".h5").back().string()).lines()[0][0];
  EXPECT_THAT(std::string(session["simulation"]), HasSubstr("world typical,servo.damping="));
}

TEST_F(Record, RefusesAWorldOrAKnobThatThereIsNot) {
  expect_refused(fast_rig + "--world hrad", 2, "did you mean \"hard\"?");
  expect_refused(fast_rig + "--world hard,servo.backlsh_deg=1", 2, "did you mean \"servo.backlash_deg\"?");
  expect_refused(fast_rig + "--world hard,servo.backlash_deg=9", 2, "a number from 0 to 3 deg");
}

TEST_F(Record, NeverUsesANumberTwice) {
  const auto first = record_briefly();
  std::filesystem::rename(first, first.parent_path() / "garden_acq-07_20200101T000000Z.h5");
  EXPECT_THAT(record_briefly().string(), HasSubstr("garden_acq-08_"));
}

TEST_F(Record, ShowsThePlanAndMovesNothingOnADryRun) {
  const Outcome outcome = run(honest_rig + "--dry-run " + brief_plan);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("4 legs of 12 frames"));
  EXPECT_THAT(outcome.out, HasSubstr("+40.0"));
  EXPECT_THAT(outcome.out, HasSubstr("-80.0"));
  EXPECT_THAT(outcome.out, HasSubstr("camera link"));
  EXPECT_FALSE(std::filesystem::exists(folder() / "recordings"));
}

TEST_F(Record, EndsWith3WhereMessagesWereLostAndSaysHowMany) {
  const Outcome outcome =
      run("record --world honest,camera.lost_subpages=0.17 --simulated=3 --fast -e garden " + brief_plan +
          " --json");
  EXPECT_EQ(outcome.code, 3);
  const std::string message = outcome.lines().back()["message"];
  EXPECT_THAT(message, testing::ContainsRegex("complete, but [0-9.]+ % of the camera's messages were lost"));
}

TEST_F(Record, RefusesOnADryRunWhatItRefusesWhenItRecords) {
  for (const char* words : {"--sync foo", "--sync 5", "--replug-patience nan", "--replug-patience -1",
                            "--speeds nan", "--frames-per-leg 0", "--world foo", "--camera-rate 0"}) {
    const std::string record = std::string("record -e garden --simulated --fast ") + words;
    const Outcome dry = run(record + " -n");
    EXPECT_EQ(dry.code, 2) << words;
    EXPECT_EQ(dry.err, run(record).err) << words;
  }
}

TEST_F(Record, GivesTheDryRunAsJson) {
  const Outcome outcome = run(honest_rig + "--dry-run --json " + brief_plan);
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto lines = outcome.lines();
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0]["legs_dps"].size(), 4U);
  EXPECT_GT(lines[0]["duration_s"], 6.0);
  for (const auto& check : lines[0]["checks"]) EXPECT_EQ(check["ok"], true) << check;
}

TEST_F(Record, AsksTheDiskForAsMuchOnADryRunAsWhenItRecords) {
  const RigProfile profile = simulation::default_rig(3, "garden").profile;
  const rig::SweepPlan plan = rig::load_plan("quick", "garden", 3, {.frames_per_leg = 45});
  const double needed_mb = 1e-6 * static_cast<double>(rig::expected_recording_bytes(plan, profile));
  EXPECT_THAT(run(honest_rig + "-n --plan quick --frames-per-leg 45").out,
              HasSubstr(fmt::format("about {:.1f} MB needed", needed_mb)));
}

TEST_F(Record, ShowsWhatEachSpeedYieldsBeforeAnythingMoves) {
  const Outcome outcome = run(honest_rig + "--dry-run --simulated-servo 180 --speeds 20,200");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("one leg / one sweep from stop to stop"));
  EXPECT_THAT(outcome.out, HasSubstr("quota: 50 valid frames a leg"));
  EXPECT_THAT(outcome.out, HasSubstr("impossible (-) with the 176 deg of this servo"));
  EXPECT_THAT(outcome.out,
              HasSubstr("200 deg/s: 4 frames need 0.825 s = 165 deg + 20 deg of ramps = 185 deg"));
  EXPECT_THAT(outcome.out, HasSubstr("6: 215 + 20 deg"));
  EXPECT_FALSE(std::filesystem::exists(folder() / "recordings"));
}

TEST_F(Record, GivesTheYieldAsArraysByFramesAWindow) {
  const Outcome outcome = run(honest_rig + "--dry-run --json --simulated-servo 180 --speeds 20,200");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto yield = outcome.lines().at(0)["yield"];
  EXPECT_EQ(yield["valid_per_leg"], 50);
  EXPECT_GT(yield["quota_s"], 30.0);
  ASSERT_EQ(yield["speeds"].size(), 2U);
  const auto& fastest = yield["speeds"][1];
  EXPECT_EQ(fastest["rate_dps"], 200.0);
  for (const char* key : {"leg", "sweep", "travel_deg", "possible"})
    EXPECT_EQ(fastest[key].size(), 6U) << key;
  EXPECT_EQ(fastest["possible"], (std::vector<bool>{true, true, true, false, false, false}));
  EXPECT_GT(fastest["quota_s"], 20.0);
  EXPECT_LT(fastest["sweep"][0], 5.0);
  const Outcome endless = run(honest_rig + "--dry-run --json --simulated-servo continuous --speeds 200");
  EXPECT_TRUE(endless.lines().at(0)["yield"]["speeds"][0]["sweep"][0].is_null());
}

TEST_F(Record, RefusesAQuotaThatNoLegCouldReach) {
  const std::string beyond = honest_rig + "--plan quick --valid-per-leg 1000 ";
  expect_refused(beyond, 2, "and a step is given up after 20 x 30 = 600");
  const Outcome dry = run(beyond + "-n");
  EXPECT_EQ(dry.code, 2);
  EXPECT_THAT(dry.out, HasSubstr("try: fewer valid frames a leg, or at least 51 frames a leg (plan)"));
  const auto checks = run(beyond + "-n --json").lines().at(0)["checks"];
  EXPECT_EQ(checks[0]["ok"], false);
  EXPECT_EQ(checks[0]["exit_code"], 2);
  EXPECT_EQ(run(honest_rig + "--plan quick --valid-per-leg 1000 --frames-per-leg 51 -n").code, 0);
}

TEST_F(Record, SaysWhyALegOnAShortServoHasMoreFrames) {
  const Outcome outcome = run(honest_rig + "-n --plan quick --simulated-servo 180");
  EXPECT_THAT(outcome.out, HasSubstr("more than 30 frames: what a leg's 23 valid ones are expected to take"));
  EXPECT_THAT(outcome.out, HasSubstr("it goes back and forth"));
  EXPECT_THAT(outcome.out, HasSubstr("legs take"));
  EXPECT_THAT(outcome.out, Not(HasSubstr("\n\n\n")));
  const Outcome winch = run(honest_rig + "-n --plan quick");
  EXPECT_THAT(winch.out, Not(HasSubstr("more than 30 frames")));
}

TEST_F(Record, ARestHasNoTableOfLegs) {
  const Outcome outcome = run("calibrate bias --world honest --simulated=3 --fast --dry-run");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("a rest of 1 min 0 s"));
  EXPECT_THAT(outcome.out, Not(HasSubstr("0 legs")));
  EXPECT_THAT(outcome.out, Not(HasSubstr("deg/s")));
}

TEST_F(Record, TellsOfItsProgressOnceASecondOfVirtualTime) {
  const Outcome outcome = run(honest_rig + "--json " + brief_plan);
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  double before_s = 0.0, end_s = 0.0;
  std::vector<std::string> phases;
  for (const auto& line : outcome.lines()) {
    if (line["event"] == "summary") end_s = line["duration_s"];
    if (line["event"] != "progress") continue;
    if (!phases.empty()) {
      EXPECT_NEAR(line["elapsed_s"].get<double>(), before_s + 1.0, 0.02);
    }
    before_s = line["elapsed_s"];
    phases.push_back(line["phase"]);
  }
  EXPECT_GT(end_s, 5.0);
  EXPECT_GE(static_cast<double>(phases.size()), end_s - 1.0);
  EXPECT_THAT(phases, ::testing::Contains("leg"));
}

TEST_F(Record, KeepsTheLicenceOfTheData) {
  ASSERT_EQ(run(honest_rig + "--licence CC-BY-4.0 " + brief_plan).code, 0);
  const std::string session = files(".h5").at(0).string();
  EXPECT_EQ(run("inspect --json " + session).lines()[0][0]["licence"], "CC-BY-4.0");
  EXPECT_THAT(run("inspect " + session).out, HasSubstr("licence      CC-BY-4.0"));
}

TEST_F(Record, RefusesSpeedsThatCannotGiveSoManyValidFramesInARow) {
  expect_refused(honest_rig + "--simulated-servo 180 --speeds 20,200 --frames-per-window 6", 2,
                 "5 x 0.125 s for 6 frames in a row");
  EXPECT_EQ(run(honest_rig + "--simulated-servo 180 --speeds 20,200 --frames-per-window 6 --dry-run").code,
            2);
  EXPECT_EQ(run(honest_rig + "--simulated-servo 180 --speeds 20,200 --frames-per-window 3 --dry-run").code,
            0);
  EXPECT_EQ(run(honest_rig + "--speeds 20,200 --frames-per-window 6 --dry-run").code, 0);
}

TEST_F(Record, GoesOnUntilEachSpeedHasItsValidFrames) {
  const Outcome outcome =
      run(honest_rig +
          "--json --simulated-servo 180 --plan quick --speeds 150 --frames-per-leg 20 --valid-per-leg 15");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto summary = outcome.lines().back();
  ASSERT_EQ(summary["speeds"].size(), 2U);
  for (const auto& speed : summary["speeds"]) {
    EXPECT_EQ(speed["valid_quota"], 15);
    EXPECT_GE(speed["valid"], 13) << speed;
  }
  EXPECT_EQ(summary["speeds_short"], 0);
  EXPECT_GT(summary["frames_swept"], 55);
  const Outcome without =
      run(honest_rig +
          "--json --simulated-servo 180 --plan quick --speeds 150 --frames-per-leg 20 --valid-per-leg 0");
  ASSERT_EQ(without.code, 0) << without.err;
  EXPECT_LE(without.lines().back()["frames_swept"], 46);
}

TEST_F(Record, ShowsTheSumWhenTheCameraCannotSendSoMuch) {
  expect_refused(honest_rig + "--camera-baud 115200 --camera-rate 8", 2, "115");
  const Outcome outcome = run(honest_rig + "--camera-baud 115200 --camera-rate 8");
  EXPECT_THAT(outcome.err, HasSubstr("1544"));
  EXPECT_THAT(outcome.err, HasSubstr("134.0 ms > 125.0 ms"));
}

TEST_F(Record, ReportsAFailedCheckOfADryRunInItsExitCode) {
  const Outcome outcome = run(honest_rig + "--dry-run --camera-baud 115200 --camera-rate 8");
  EXPECT_EQ(outcome.code, 2);
  EXPECT_THAT(outcome.out, HasSubstr("NOT OK"));
}

TEST_F(Record, RefusesAnOutputFolderThatCannotBeWritten) {
  write("taken", {});
  expect_refused(honest_rig + "--output taken " + brief_plan, 7, "taken");
  expect_refused(honest_rig + "--output /proc/recordings " + brief_plan, 7, "/proc/recordings");
  EXPECT_EQ(run(honest_rig + "--output taken " + brief_plan).out, "");
}

TEST_F(Record, RefusesContradictingWords) {
  expect_refused("record --simulated --camera /dev/null --environment garden", 2, "exclude each other");
  expect_refused("record --environment garden --simulated-servo 180 --camera a --gyro b --servo c", 2,
                 "--simulated");
  expect_refused("record --environment garden", 2, "no port is given for camera, gyro, servo");
  expect_refused("record --environment garden --rig nowhere.toml", 2, "nowhere.toml");
  expect_refused("record --environment garden --scene kitchen", 2, "--scene and --world need --simulated");
  expect_refused("record --fast --environment garden --camera a --gyro b --servo c", 2, "--fast");
  expect_refused("record --environment garden --control --simulated -n", 2, "no page is served");
  expect_refused(honest_rig + "--plan nowhere.toml", 2, "nowhere.toml");
  expect_refused(honest_rig + "--speeds 30,900", 2, "900");
  expect_refused(honest_rig + "--licence " + std::string(1001, 'x'), 2, "--licence is not a line");
}

TEST_F(Record, SaysWhichPortDoesNotExist) {
  expect_refused(
      "record --environment garden --plan quick --camera /dev/ttyUSB97 --gyro /dev/ttyUSB98 --servo "
      "/dev/ttyUSB99",
      4, "/dev/ttyUSB97");
}

TEST_F(Record, ClosesTheFileOnCtrlC) {
  const pid_t process = start({"record", "--world", "honest", "--simulated=3", "--fast", "--environment",
                               "garden", "--json", "--frames-per-leg", "1000"});  // in virtual time: hours
  const auto records = [&] {
    return !files(".journal").empty() && std::filesystem::file_size(files(".journal")[0]) > 100'000;
  };
  EXPECT_TRUE(comes_true(records));
  kill(process, SIGINT);
  const Outcome outcome = wait(process);
  EXPECT_EQ(outcome.code, 130) << outcome.err;
  EXPECT_EQ(files(".h5").size(), 1U);
  EXPECT_TRUE(files(".journal").empty());
}

TEST_F(Record, DrawsOverItsStatusOnATerminalOnlyAndNotIfNoColourIsWanted) {
  const Outcome plain = run_on_terminal("TERM=xterm NO_COLOR=1", honest_rig + brief_plan);
  const Outcome drawn = run_on_terminal("TERM=xterm", honest_rig + brief_plan);
  ASSERT_EQ(drawn.code, 0) << drawn.out;
  EXPECT_THAT(drawn.out, HasSubstr("\x1b["));
  EXPECT_THAT(drawn.out, HasSubstr("camera  "));
  EXPECT_THAT(drawn.out, HasSubstr("-80 [.. ..] +80 deg/s"));
  EXPECT_THAT(drawn.out, HasSubstr("0 of 4 speeds done"));
  ASSERT_EQ(plain.code, 0) << plain.out;
  EXPECT_THAT(plain.out, Not(HasSubstr("\x1b")));
}

TEST_F(Record, SimulatesEveryKindOfServo) {
  for (const char* servo : {"180", "270", "continuous"}) {
    const Outcome outcome = run(honest_rig + "--json --simulated-servo " + servo + " " + brief_plan);
    ASSERT_EQ(outcome.code, 0) << servo << outcome.err << outcome.out;
    EXPECT_GE(outcome.lines().back()["frames_swept"], 48) << servo;
    EXPECT_GT(outcome.lines().back()["frames_valid"], 10) << servo;
  }
}

}  // namespace
}  // namespace thermorig::tests
