// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include <fstream>

#include "program.h"
#include "thermorig/rig/profile/profile_file.h"

namespace thermorig::tests {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const std::string fast = " --world honest --simulated=3 --fast ";

class Calibrate : public ProgramTest {
 protected:
  RigProfile profile(const std::string& name) const { return rig::read_profile(folder() / name); }

  void expect_refused(const std::string& arguments, int code, const std::string& sentence) {
    const Outcome outcome = run("calibrate " + arguments);
    EXPECT_EQ(outcome.code, code) << arguments << "\n" << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(sentence)) << arguments;
    EXPECT_THAT(outcome.err, HasSubstr("try: ")) << arguments;
  }
};

TEST_F(Calibrate, RecordsASessionAndKeepsTheResultInANewProfile) {
  const Outcome outcome = run("calibrate bias" + fast + "--save bench.toml");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("gyro bias"));
  EXPECT_THAT(outcome.out, HasSubstr("default, not measured"));
  EXPECT_THAT(outcome.out, HasSubstr("written to bench.toml"));
  ASSERT_EQ(files(".h5").size(), 1U);
  EXPECT_THAT(files(".h5")[0].string(), HasSubstr("recordings/calibration/calibration_acq-01_"));
  const RigProfile kept = profile("bench.toml");
  EXPECT_NE(kept.gyro.bias_dps, 0.0);
  EXPECT_LT(kept.gyro.bias_uncertainty_dps, 0.1);
  EXPECT_THAT(kept.gyro.bias_measured_utc, ::testing::EndsWith("Z"));
  EXPECT_EQ(kept.camera.link.port, "");
}

TEST_F(Calibrate, AddsToTheProfileThatTheRigHas) {
  ASSERT_EQ(run("calibrate bias" + fast + "--save bench.toml").code, 0);
  const Outcome outcome = run("calibrate latency" + fast + "--rig bench.toml --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto summary = outcome.lines().back();
  EXPECT_EQ(summary["event"], "summary");
  EXPECT_EQ(summary["calibration"], "latency");
  EXPECT_EQ(summary["profile"], "bench.toml");
  EXPECT_EQ(summary["sessions"].size(), 1U);
  EXPECT_TRUE(summary["before"]["camera_latency_s"]["measured_utc"].is_null());
  const RigProfile kept = profile("bench.toml");
  EXPECT_NEAR(kept.camera.link.latency_s, summary["result"]["camera_latency_s"]["value"], 1e-6);
  EXPECT_EQ(kept.camera.link.latency_measured_utc, summary["measured_utc"]);
  EXPECT_NE(kept.gyro.bias_measured_utc, "");
}

TEST_F(Calibrate, OnlyPrintsWithoutAProfileAndSaysHowToKeepIt) {
  const Outcome outcome = run("calibrate bias" + fast);
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("not written"));
  EXPECT_THAT(outcome.out, HasSubstr("thermorig calibrate bias --session recordings/calibration/"));
  EXPECT_TRUE(files(".toml").empty());
}

TEST_F(Calibrate, TakesSessionsThatAreThereAndEachOnce) {
  ASSERT_EQ(run("calibrate latency" + fast).code, 0);
  const std::string session = files(".h5")[0].string();
  const Outcome one = run("calibrate latency --json --session " + session);
  ASSERT_EQ(one.code, 0) << one.err;
  std::filesystem::copy_file(folder() / session, folder() / "copy.h5");
  const Outcome twice = run("calibrate latency --json --session " + session + " copy.h5 --save bench.toml");
  ASSERT_EQ(twice.code, 0) << twice.err;
  EXPECT_EQ(twice.lines()[0]["sessions"].size(), 1U);
  EXPECT_EQ(twice.lines()[0]["skipped"][0]["file"], "copy.h5");
  EXPECT_EQ(twice.lines()[0]["result"], one.lines()[0]["result"]);
}

TEST_F(Calibrate, LeavesOutSessionsThatCannotTellAndNamesThem) {
  ASSERT_EQ(run("calibrate latency" + fast).code, 0);
  ASSERT_EQ(run("calibrate bias" + fast).code, 0);
  const Outcome outcome = run("calibrate latency --session recordings/calibration/*.h5");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("skipped      recordings/calibration/calibration_acq-02_"));
  EXPECT_THAT(outcome.out, HasSubstr("the camera's delay cannot be measured"));
}

TEST_F(Calibrate, DoesNotPoolSessionsOfDifferentRigs) {
  ASSERT_EQ(run("calibrate bias" + fast).code, 0);
  ASSERT_EQ(run("calibrate bias --world honest --simulated=4 --fast").code, 0);
  expect_refused("bias --session recordings/calibration/*.h5", 2, "different rigs");
}

TEST_F(Calibrate, MakesTheFolderOfProfiles) {
  const Outcome outcome = run("calibrate bias" + fast + "--save settings/of/rigs/bench.toml");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(profile("settings/of/rigs/bench.toml").gyro.bias_measured_utc, "");
}

TEST_F(Calibrate, LooksAtTheProfileBeforeItRecords) {
  std::ofstream(folder() / "notes.toml") << "this is no profile";
  std::ofstream(folder() / "file") << "this is not a folder";
  for (const std::string dry_run : {"", " --dry-run"}) {
    EXPECT_EQ(run("calibrate bias" + fast + "--save notes.toml" + dry_run).code, 2);
    expect_refused("bias" + fast + "--save file/bench.toml" + dry_run, 7, "cannot be written");
    expect_refused("bias" + fast + "--rig nosuch" + dry_run, 2, "no such profile");
  }
  EXPECT_TRUE(files(".h5").empty());
}

TEST_F(Calibrate, SaysWhatToTryWhereASessionCannotTell) {
  ASSERT_EQ(run("calibrate bias" + fast).code, 0);
  const std::string session = files(".h5")[0].string();
  expect_refused("latency --save bench.toml --session " + session, 3, "calibration_acq-01_");
  expect_refused("latency --session " + session, 3, "turns back and forth");
  EXPECT_FALSE(std::filesystem::exists(folder() / "bench.toml"));
}

TEST_F(Calibrate, KeepsALensWhichLiveThenKnows) {
  const std::string lens =
      " --world honest,camera.pitch_error=-0.02,camera.distortion=0.04 --simulated=2 --fast ";
  const Outcome outcome = run("calibrate lens" + lens + "--save bench.toml --json");
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const auto summary = outcome.lines().back();
  EXPECT_EQ(summary["calibration"], "lens");
  EXPECT_NEAR(summary["result"]["pitch_scale"]["value"], 0.98, 0.005);
  EXPECT_TRUE(summary["before"]["measured_utc"].is_null());
  const RigProfile kept = profile("bench.toml");
  EXPECT_NEAR(kept.camera.pitch_scale, summary["result"]["pitch_scale"]["value"], 1e-6);
  EXPECT_NEAR(kept.camera.distortion, 0.04, 3.0 * kept.camera.distortion_uncertainty);
  EXPECT_EQ(kept.camera.lens_measured_utc, summary["measured_utc"]);
  const Outcome live =
      run("live --rig bench.toml --environment kitchen --plan quick --map kitchen.map" + lens);
  EXPECT_EQ(live.code, 0) << live.err;
}

TEST_F(Calibrate, RefusesALensThatNoProfileMayHave) {
  std::ofstream(folder() / "bent.toml") << "[camera]\npitch_scale = 1.5\n";
  expect_refused("lens" + fast + "--rig bent.toml", 2, "pitch_scale");
}

TEST_F(Calibrate, ShowsThePlanAndMovesNothingOnADryRun) {
  for (const char* what : {"bias", "latency", "scale", "orientation", "lens"}) {
    const Outcome outcome = run(std::string("calibrate ") + what + fast + "--dry-run");
    EXPECT_EQ(outcome.code, 0) << what << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr(std::string("plan calibrate-") + what)) << what;
  }
  EXPECT_FALSE(std::filesystem::exists(folder() / "recordings"));
}

TEST_F(Calibrate, KeepsSimulatedFiguresOutOfTheProfileOfARealRig) {
  RigProfile real;
  real.camera.link.port = "/dev/ttyUSB7";
  rig::write_profile(folder() / "real.toml", real);
  expect_refused("bias" + fast + "--save real.toml", 2, "profile of a real rig");
  EXPECT_TRUE(files(".h5").empty());
  EXPECT_EQ(profile("real.toml").gyro.bias_measured_utc, "");
}

class CalibrateCheck : public Calibrate {
 protected:
  /// A profile of the simulated rig with a camera latency that was measured; `later_s` is added to it.
  void make_profile(const std::string& name, double later_s) {
    ASSERT_EQ(run("calibrate latency" + fast + "--save " + name).code, 0);
    RigProfile measured = profile(name);
    measured.camera.link.latency_s += later_s;
    rig::write_profile(folder() / name, measured);
  }
};

TEST_F(CalibrateCheck, PrintsALineAConstantAndWritesNoProfile) {
  make_profile("bench.toml", 0.0);
  const RigProfile before = profile("bench.toml");
  const Outcome outcome = run("calibrate check" + fast + "--rig bench.toml");
  EXPECT_EQ(outcome.code, 0) << outcome.out << outcome.err;
  for (const char* constant : {"gyro scale", "gyro bias", "gyro filter delay", "camera latency",
                               "camera rows", "servo scale", "servo at +200 deg/s", "servo clock wander"})
    EXPECT_THAT(outcome.out, HasSubstr(constant));
  EXPECT_THAT(outcome.out, HasSubstr("not checked\n  never measured: the profile assumes it"));
  EXPECT_THAT(outcome.out, HasSubstr("try: thermorig calibrate scale (gyro scale, servo scale)"));
  EXPECT_EQ(profile("bench.toml").camera.link.latency_measured_utc, before.camera.link.latency_measured_utc);
  ASSERT_EQ(files(".h5").size(), 2U);
  EXPECT_THAT(files(".h5")[1].string(), HasSubstr("recordings/calibration/calibration_acq-02_"));
}

TEST_F(CalibrateCheck, EndsWithACodeOfItsOwnWhereAConstantContradicts) {
  make_profile("stale.toml", -0.012);
  const Outcome outcome = run("calibrate check" + fast + "--rig stale.toml");
  EXPECT_EQ(outcome.code, 9) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("contradicts\n  the images come later"));
  EXPECT_THAT(outcome.out, HasSubstr("try: thermorig calibrate latency (camera latency)"));
  const Outcome again = run("calibrate check --json --session " + files(".h5")[1].string());
  EXPECT_EQ(again.code, 9) << again.out << again.err;
  const auto summary = again.lines().back();
  EXPECT_EQ(summary["calibration"], "check");
  EXPECT_EQ(summary["exit_code"], 9);
  const auto session = summary["sessions"][0];
  EXPECT_TRUE(session["contradicted"]);
  for (const auto& constant : session["constants"]) {
    EXPECT_EQ(constant["verdict"] == "contradicts", constant["name"] == "camera latency") << constant;
    if (constant["name"] != "camera latency") continue;
    EXPECT_EQ(constant["unit"], "s");
    EXPECT_NEAR(constant["session"]["value"].get<double>() - constant["profile"]["value"].get<double>(),
                0.012, 0.003);
    EXPECT_EQ(constant["advice"], "thermorig calibrate latency");
  }
}

TEST_F(CalibrateCheck, IsRunFirstByARecordingWhichRefusesAStaleProfile) {
  make_profile("stale.toml", -0.012);
  const std::string record = "record -e kitchen " + brief_plan + fast + "--rig stale.toml --check";
  const Outcome refused = run(record);
  EXPECT_EQ(refused.code, 9) << refused.out << refused.err;
  EXPECT_THAT(refused.err, HasSubstr("the profile does not hold any more: camera latency"));
  EXPECT_THAT(refused.err, HasSubstr("try: thermorig calibrate latency"));
  EXPECT_FALSE(std::filesystem::exists(folder() / "recordings/kitchen"));
  const Outcome all_the_same = run(record + " --no-preflight --json");
  EXPECT_EQ(all_the_same.code, 0) << all_the_same.err;
  EXPECT_TRUE(std::filesystem::exists(folder() / "recordings/kitchen"));
  int checks = 0;
  for (const auto& line : all_the_same.lines())
    if (line["event"] == "check") checks += line["contradicted"].get<bool>() ? 1 : 0;
  EXPECT_EQ(checks, 1);
}

TEST_F(CalibrateCheck, LetsARecordingGoOnWhereTheProfileHolds) {
  make_profile("bench.toml", 0.0);
  const Outcome outcome = run("record -e kitchen " + brief_plan + fast + "--rig bench.toml --check");
  EXPECT_EQ(outcome.code, 0) << outcome.out << outcome.err;
  EXPECT_TRUE(std::filesystem::exists(folder() / "recordings/kitchen"));
}

TEST_F(CalibrateCheck, IsNamedByTheDoctor) {
  EXPECT_THAT(run("doctor --world honest --simulated=3 --plan quick").out,
              HasSubstr("no constant of this profile is measured: `thermorig calibrate` measures them"));
  make_profile("bench.toml", 0.0);
  const std::string seen = run("doctor --world honest --simulated=3 --plan quick --rig bench.toml").out;
  EXPECT_THAT(seen, HasSubstr("camera latency measured, the oldest on "));
  EXPECT_THAT(seen, HasSubstr("`thermorig calibrate check` shows whether they still hold"));
}

TEST_F(CalibrateCheck, RefusesWordsThatWouldDoNothing) {
  expect_refused("check --save bench.toml" + fast, 2, "writes no profile");
  expect_refused("check --session missing.h5 --rig bench.toml", 2, "the profile that it was recorded with");
  expect_refused("check --marks" + fast, 2, "--marks");
  const Outcome plan = run("calibrate check" + fast + "--dry-run");
  EXPECT_EQ(plan.code, 0) << plan.err;
  EXPECT_THAT(plan.out, HasSubstr("plan calibrate-check"));
  EXPECT_FALSE(std::filesystem::exists(folder() / "recordings"));
}

TEST_F(Calibrate, RefusesWordsThatContradictEachOther) {
  expect_refused("tempo" + fast, 2, "tempo");
  expect_refused("bias --marks" + fast, 2, "--marks");
  expect_refused("scale --angle 360" + fast, 2, "--marks");
  expect_refused("scale --marks --angle 10" + fast, 2, "out of range");
  expect_refused("scale --marks --angle nan" + fast, 2, "out of range");
  expect_refused("bias --session missing.h5", 2, "no such file");
  expect_refused("bias --session missing.h5" + fast, 2, "--session");
  expect_refused("bias --fast", 2, "--simulated=4");
  expect_refused("bias", 2, "no port is given");
}

}  // namespace
}  // namespace thermorig::tests
