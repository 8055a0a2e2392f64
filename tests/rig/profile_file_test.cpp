// SPDX-License-Identifier: MIT
#include "thermorig/rig/profile/profile_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "simulated_bus.h"
#include "support/unusual_profile.h"
#include "thermorig/core/error.h"

namespace thermorig::rig {
namespace {

using ::testing::HasSubstr;

std::string refusal_of_profile(const std::string& text) {
  try {
    parse_profile(text, "bench.toml");
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_usage);
    return error.what();
  }
  return "nothing was refused";
}

TEST(ProfileFile, GivesEveryFieldBack) {
  const RigProfile profile = tests::unusual_profile();
  const std::string text = profile_text(profile);
  const RigProfile again = parse_profile(text, "bench.toml");
  EXPECT_EQ(tests::difference(again, profile), "");
  EXPECT_EQ(profile_text(again), text);
}

TEST(ProfileFile, GivesTheSettingsOfTheGyrosProtocolBack) {
  RigProfile profile;
  profile.gyro.protocol = "mavlink";
  profile.gyro.settings = {{"system", 42.0}, {"raw_scale_dps", 0.0573}};
  const std::string text = profile_text(profile);
  EXPECT_THAT(text, HasSubstr("[gyro.mavlink]\nsystem = 42 "));
  EXPECT_EQ(parse_profile(text, "bench.toml").gyro.settings, profile.gyro.settings);
  EXPECT_THAT(profile_text(RigProfile()), testing::Not(HasSubstr("gyro.mavlink")));
}

TEST(ProfileFile, TakesASketchForAllThatItSaysAndKeysOverIt) {
  const RigProfile profile = parse_profile(
      "[gyro]\nbaud = 57600\nsketch = \"tockn-mpu6050\"\n[gyro.text]\ntime_column = 9\n", "b.toml");
  EXPECT_EQ(profile.gyro.protocol, "text");
  EXPECT_EQ(profile.gyro.model, "MPU6050_tockn");
  EXPECT_EQ(profile.gyro.link.baud, 57600U);  // its own is 9600
  EXPECT_EQ(profile.gyro.text.prefix, "gyroX");
  EXPECT_EQ(profile.gyro.text.rate, (std::array<int, 3>{1, 4, 7}));
  EXPECT_EQ(profile.gyro.text.time, 9);
  const std::string text = profile_text(profile);
  EXPECT_EQ(profile_text(parse_profile(text, "b.toml")), text);
  EXPECT_THAT(refusal_of_profile("[gyro]\nsketch = \"tockn\"\n"), HasSubstr("tockn-mpu6050"));
  EXPECT_THAT(refusal_of_profile("[gyro]\nsketch = \"tockn-mpu6050\"\nprotocol = \"mavlink\"\n"),
              HasSubstr("the protocol is mavlink"));
}

TEST(ProfileFile, RefusesSettingsThatTheGyrosProtocolDoesNotHave) {
  const std::string mavlink = "[gyro]\nprotocol = \"mavlink\"\n[gyro.mavlink]\n";
  EXPECT_THAT(refusal_of_profile(mavlink + "sistem = 1\n"),
              HasSubstr("bench.toml:4: unknown key \"sistem\""));
  EXPECT_THAT(refusal_of_profile(mavlink + "system = 256\n"), HasSubstr("from 0 to 255"));
  EXPECT_THAT(refusal_of_profile(mavlink + "system = 1.5\n"), HasSubstr("not a whole number"));
  EXPECT_THAT(refusal_of_profile("[gyro.mavlink]\nsystem = 1\n"), HasSubstr("unknown key \"mavlink\""));
}

TEST(ProfileFile, RefusesCalibrationsThatMeanNothing) {
  EXPECT_THAT(refusal_of_profile("[gyro]\nscale = 0.1\n"), HasSubstr("from 0.5 to 2"));
  EXPECT_THAT(refusal_of_profile("[gyro]\nscale_uncertainty = -0.1\n"), HasSubstr("out of range"));
  EXPECT_THAT(refusal_of_profile("[gyro]\nbias_dps = nan\n"), HasSubstr("out of range"));
  EXPECT_THAT(refusal_of_profile("[gyro]\nbias_measured_utc = \"yesterday\"\n"), HasSubstr("bench.toml:2"));
  EXPECT_THAT(refusal_of_profile("[camera]\nlatency_measured_utc = \"2026-07-25 at noon\"\n"),
              HasSubstr("not a date"));
  EXPECT_THAT(refusal_of_profile("[servo]\nloop_hz = 0\n"), HasSubstr("from 0.5 to 100"));
  EXPECT_THAT(refusal_of_profile("[camera]\nwander_ppm = 0\n"), HasSubstr("out of range"));
}

TEST(ProfileFile, IsNeitherDeepNorAPipeNorADevice) {
  EXPECT_THAT(refusal_of_profile("a = " + std::string(10'000, '[')),
              HasSubstr("nested more than 32 levels deep"));
  for (const char* device : {"/dev/zero", "/dev"}) {
    try {
      read_profile(device);
      ADD_FAILURE() << device;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::bad_usage) << device;
      EXPECT_THAT(error.what_happened(), HasSubstr("cannot read the rig profile: it is ")) << device;
    }
  }
}

TEST(ProfileFile, IsRefusedWhereItSaysNothing) {
  for (const char* text : {"", "# a comment\n", "[camera]\n[gyro.text]\n"})
    EXPECT_THAT(refusal_of_profile(text), HasSubstr("bench.toml: this rig profile says nothing")) << text;
}

TEST(ProfileFile, IsRefusedBeforeItIsMeasuredWhereItIsWriteProtected) {
  namespace fs = std::filesystem;
  const fs::path path = fs::path(testing::TempDir()) / "protected.toml";
  fs::remove(path);
  write_profile(path, RigProfile());
  require_profile_storage(path);
  fs::permissions(path, fs::perms::owner_read);
  try {
    require_profile_storage(path);
    ADD_FAILURE() << "nothing was refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::storage);
    EXPECT_THAT(error.what(), HasSubstr("it is write-protected"));
  }
}

TEST(ProfileFile, KeepsDefaultsForWhatIsLeftOut) {
  const RigProfile profile = parse_profile("[camera]\nport = \"/dev/ttyUSB1\"\n", "bench.toml");
  EXPECT_EQ(profile.camera.link.port, "/dev/ttyUSB1");
  EXPECT_EQ(profile.camera.link.baud, 460800U);
  EXPECT_EQ(profile.servo.travel_deg, 2160.0);
}

TEST(ProfileFile, WritesACommentForPeople) {
  const RigProfile profile;
  EXPECT_THAT(profile_text(profile), HasSubstr("bits per second"));
}

TEST(ProfileFile, NamesLineAndWhatIsAllowed) {
  EXPECT_THAT(refusal_of_profile("[camera]\n\nbauds = 9600\n"),
              HasSubstr("bench.toml:3: unknown key \"bauds\""));
  EXPECT_THAT(refusal_of_profile("[camera]\n\nbauds = 9600\n"), HasSubstr("did you mean \"baud\"?"));
  EXPECT_THAT(refusal_of_profile("[camera]\n\nbauds = 9600\n"), HasSubstr("output_rate_hz"));
  EXPECT_THAT(refusal_of_profile("[kamera]\nbaud = 9600\n"), HasSubstr("unknown key \"kamera\""));
  EXPECT_THAT(refusal_of_profile("[gyro]\naxis = \"w\"\n"), HasSubstr("one of: x, y, z"));
  EXPECT_THAT(refusal_of_profile("[gyro]\nprotocol = \"textt\"\n"), HasSubstr("did you mean \"text\"?"));
  EXPECT_THAT(refusal_of_profile("[gyro]\nsign = 0\n"), HasSubstr("1 or -1"));
  EXPECT_THAT(refusal_of_profile("[servo]\nmax_rate_dps = 900\n"), HasSubstr("from 0.1 to 300"));
  EXPECT_THAT(refusal_of_profile("[servo]\nmax_rate_dps = \"fast\"\n"), HasSubstr("not a number"));
  EXPECT_THAT(refusal_of_profile("[servo]\nacceleration_dps2 = inf\n"), HasSubstr("out of range"));
  EXPECT_THAT(refusal_of_profile("[servo]\npulse_min_us = 2000\npulse_max_us = 1000\n"),
              HasSubstr("bench.toml:2"));
  EXPECT_THAT(refusal_of_profile("[servo]\nkind = \"continuous\"\n"), HasSubstr("full_rate_dps"));
  EXPECT_THAT(refusal_of_profile("[servo]\ntravel_deg = 10\nstop_margin_deg = 5\n"), HasSubstr("no travel"));
  EXPECT_THAT(refusal_of_profile("camera = 3\n"), HasSubstr("not a table"));
  EXPECT_THAT(refusal_of_profile("[camera]\nport = \n"), HasSubstr("bench.toml:2: not valid TOML"));
}

TEST(ProfileFile, IsWrittenAndReadAgain) {
  const test::TemporaryFolder folder;
  write_profile(folder.path() / "bench.toml", tests::unusual_profile());
  EXPECT_EQ(profile_text(read_profile(folder.path() / "bench.toml")), profile_text(tests::unusual_profile()));
  EXPECT_THROW(read_profile(folder.path() / "none.toml"), Error);
  write_profile(folder.path() / "new" / "folder" / "bench.toml", tests::unusual_profile());
  EXPECT_NO_THROW(read_profile(folder.path() / "new" / "folder" / "bench.toml"));
  EXPECT_THROW(write_profile(folder.path() / "bench.toml" / "no_folder.toml", tests::unusual_profile()),
               Error);
}

}  // namespace
}  // namespace thermorig::rig
