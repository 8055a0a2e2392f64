// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "support/format_1_header.h"
#include "support/unusual_profile.h"
#include "synthetic_session.h"
#include "thermorig/core/error.h"
#include "thermorig/storage/recording_header/header_json.h"

namespace thermorig::recording_header {
namespace {

RecordingHeader sound_header() {
  return session::synthetic_session(0).raw.header;
}

TEST(Header, KeepsCalibrationsAndWhatBoundsRestOn) {
  RecordingHeader header = sound_header();
  header.profile = tests::unusual_profile();
  const RigProfile read = header_from_json_text(header_to_json_text(header), "test").profile;
  EXPECT_EQ(tests::difference(read, header.profile), "");
}

TEST(Header, OfTheTimeBeforeSessionFormat2IsRead) {
  RecordingHeader header = sound_header();
  header.profile = tests::format_1_profile(tests::unusual_profile());
  const std::string text = tests::format_1_header(header);
  EXPECT_EQ(tests::difference(header_from_json_text(text, "test").profile, header.profile), "");
}

TEST(Header, OfTheTimeBeforeSessionFormat2ThatIsNoneIsRefused) {
  const nlohmann::json sound = nlohmann::json::parse(tests::format_1_header(sound_header()));
  const auto refused = [&](const char* where, const nlohmann::json& value) {
    nlohmann::json changed = sound;
    changed[nlohmann::json::json_pointer(where)] = value;
    EXPECT_THROW(header_from_json_text(changed.dump(), "test"), Error) << where << " " << value;
  };
  refused("/profile/camera/link", 3);
  refused("/profile/gyro/link", nlohmann::json::array());
  refused("/profile/gyro/text", "columns");
  refused("/profile/gyro/text/rate", {0, 1});
  refused("/profile/gyro/axis", 3);
  refused("/profile/gyro/axis", -1);
  refused("/profile/gyro/settings", {{"system", "one"}});
  for (const char* where : {"/profile/gyro/sign", "/profile/gyro/text/rate/1", "/profile/camera/link/baud"})
    for (const nlohmann::json& number :
         {nlohmann::json(3.3e21), nlohmann::json(1.5), nlohmann::json(1LL << 32U), nlohmann::json("1")})
      refused(where, number);
  EXPECT_NO_THROW(header_from_json_text(sound.dump(), "test"));
}

TEST(Header, ThatHoldsAValueOutOfRangeSaysFieldValueAndRange) {
  nlohmann::json changed = nlohmann::json::parse(header_to_json_text(sound_header()));
  changed["profile"]["gyro"]["latency_s"] = 5;
  try {
    header_from_json_text(changed.dump(), "test");
    FAIL() << "nothing was refused";
  } catch (const Error& error) {
    EXPECT_THAT(error.what_happened(), ::testing::HasSubstr("the profile's [gyro] latency_s = 5 is out of "
                                                            "range: a number from -0.1 to 1"));
  }
}

TEST(Header, WithoutTheProfileSaysNothingOfIt) {
  RecordingHeader header = sound_header();
  header.profile = tests::unusual_profile();
  const std::string text = header_to_json_text(header, ProfileAndPlan::elsewhere);
  EXPECT_FALSE(nlohmann::json::parse(text).contains("profile"));
  const RigProfile read = header_from_json_text(text, "test", ProfileAndPlan::elsewhere).profile;
  EXPECT_EQ(tests::difference(read, RigProfile()), "");
  EXPECT_THROW(header_from_json_text(text, "test"), Error);
}

TEST(Header, WithCalibrationsThatMakeNoSenseIsRefused) {
  const auto refused = [](auto change) {
    RecordingHeader header = sound_header();
    change(header.profile);
    EXPECT_THROW(header_to_json_text(header), Error);
  };
  const double none = std::numeric_limits<double>::quiet_NaN();
  refused([](RigProfile& rig) { rig.gyro.scale = 0.0; });
  refused([](RigProfile& rig) { rig.servo.scale = -1.0; });
  refused([](RigProfile& rig) { rig.servo.loop_hz = 0.0; });
  refused([&](RigProfile& rig) { rig.gyro.bias_dps = none; });
  refused([&](RigProfile& rig) { rig.camera.link.latency_uncertainty_s = none; });
  refused([](RigProfile& rig) { rig.gyro.link.largest_constant_delay_s = -0.001; });
  refused([](RigProfile& rig) { rig.servo.link.wander_ppm = -1.0; });
  refused([](RigProfile& rig) { rig.gyro.bias_uncertainty_dps = -1.0; });
}

TEST(Header, WithAGyroProtocolThatIsNotKnownIsRefusedAndTheNearestNamed) {
  const std::string text = header_to_json_text(sound_header());
  ASSERT_EQ(sound_header().profile.gyro.protocol, "witmotion");
  std::string misspelt = text;
  misspelt.replace(misspelt.find("\"witmotion\""), 11, "\"witmocion\"");
  try {
    header_from_json_text(misspelt, "test");
    FAIL() << "nothing was refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::not_a_session);
    EXPECT_THAT(error.what_happened(), ::testing::HasSubstr("did you mean \"witmotion\"?"));
  }
}

TEST(Header, KeepsTheSettingsOfTheGyrosProtocol) {
  RecordingHeader header = sound_header();
  header.profile.gyro.protocol = "mavlink";
  header.profile.gyro.settings = {{"system", 3.0}, {"raw_scale_dps", 0.0573}};
  const GyroProfile read = header_from_json_text(header_to_json_text(header), "test").profile.gyro;
  EXPECT_EQ(read.protocol, "mavlink");
  EXPECT_EQ(read.settings, header.profile.gyro.settings);
  for (const double wrong : {-1.0, 256.0, 1.5, std::numeric_limits<double>::quiet_NaN()}) {
    header.profile.gyro.settings = {{"system", wrong}};
    EXPECT_THROW(header_to_json_text(header), Error) << wrong;
  }
}

TEST(Header, WithASettingThatTheGyrosProtocolDoesNotHaveIsRefused) {
  RecordingHeader header = sound_header();
  header.profile.gyro.settings = {{"system", 1.0}};
  EXPECT_THROW(header_to_json_text(header), Error);
}

TEST(Header, KeepsTheLicenceOfTheDataWhereOneIsStated) {
  RecordingHeader header = sound_header();
  header.licence = "";
  EXPECT_FALSE(nlohmann::json::parse(header_to_json_text(header)).contains("licence"));
  EXPECT_EQ(header_from_json_text(header_to_json_text(header), "test").licence, "");
  header.licence = "CC-BY-4.0, früh";
  EXPECT_EQ(header_from_json_text(header_to_json_text(header), "test").licence, "CC-BY-4.0, früh");
}

TEST(Header, WithALicenceThatIsNoLineOfTextIsRefused) {
  RecordingHeader header = sound_header();
  for (const std::string& none :
       {std::string("free\nnow"), std::string("\x1b[2J"), std::string(400, '\xff'), std::string(1001, 'x')}) {
    header.licence = none;
    EXPECT_THROW(header_to_json_text(header), Error);
  }
}

TEST(Header, KeepsOperatorPlaceAndNoteWhereTheyAreStated) {
  RecordingHeader header = sound_header();
  const nlohmann::json without = nlohmann::json::parse(header_to_json_text(header));
  for (const char* key : {"operator", "place", "note"}) EXPECT_FALSE(without.contains(key)) << key;
  header.operator_name = "A. Person";
  header.place = "room 2.11";
  header.note = "the window was open, früh";
  const RecordingHeader read = header_from_json_text(header_to_json_text(header), "test");
  EXPECT_EQ(read.operator_name, header.operator_name);
  EXPECT_EQ(read.place, header.place);
  EXPECT_EQ(read.note, header.note);
  for (std::string RecordingHeader::*said :
       {&RecordingHeader::operator_name, &RecordingHeader::place, &RecordingHeader::note}) {
    RecordingHeader bad = header;
    bad.*said = "two\nlines";
    EXPECT_THROW(header_to_json_text(bad), Error);
  }
}

TEST(Header, WithTimesBeyondAnyClockIsRefused) {
  const auto refused = [](auto change) {
    RecordingHeader header = sound_header();
    change(header.profile);
    EXPECT_THROW(header_to_json_text(header), Error);
  };
  refused([](RigProfile& rig) { rig.camera.link.latency_s = -1e300; });
  refused([](RigProfile& rig) { rig.gyro.link.latency_uncertainty_s = 1e30; });
  refused([](RigProfile& rig) { rig.servo.link.largest_constant_delay_s = 1e12; });
  refused([](RigProfile& rig) { rig.camera.output_rate_hz = 1e-300; });
  refused([](RigProfile& rig) { rig.gyro.output_rate_hz = 1e18; });
  refused([](RigProfile& rig) { rig.servo.settle_s = 1e20; });
}

TEST(Header, ThatCannotBeReadIsToldInWordsForPeople) {
  const auto told = [](const std::string& text) {
    try {
      header_from_json_text(text, "test");
    } catch (const Error& error) {
      return error.what_happened();
    }
    return std::string("nothing was refused");
  };
  EXPECT_EQ(told("{}").substr(0, 37), "its header cannot be read: key 'uuid'");
  for (const char* text : {"", "{", "[]", "{\"uuid\": 3}"})
    EXPECT_EQ(told(text).find("json.exception"), std::string::npos) << told(text);
  nlohmann::json sound = nlohmann::json::parse(header_to_json_text(sound_header()));
  sound["acquisition"] = "DEEP";
  std::string deep = sound.dump();
  deep.replace(deep.find("\"DEEP\""), 6, std::string(200'000, '[') + std::string(200'000, ']'));
  EXPECT_EQ(told(deep), "its header cannot be read: array is no whole number, or too large");
}

TEST(Header, ThatCountsFromATimeThatNoClockShowsIsRefused) {
  nlohmann::json changed = nlohmann::json::parse(header_to_json_text(sound_header()));
  for (const std::int64_t ns :
       {std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::max(),
        std::int64_t{1'000'000'000'000'000'001}, std::int64_t{-1'000'000'000'000'000'001}}) {
    changed["time_reference"] = ns;
    EXPECT_THROW(header_from_json_text(changed.dump(), "test"), Error) << ns;
  }
  changed["time_reference"] = 1'000'000'000'000'000'000;
  EXPECT_NO_THROW(header_from_json_text(changed.dump(), "test"));
}

TEST(Header, WithANumberThatIsNoneOfItsKindIsRefused) {
  const nlohmann::json sound = nlohmann::json::parse(header_to_json_text(sound_header()));
  const auto refused = [&](const char* where, const nlohmann::json& number) {
    nlohmann::json changed = sound;
    changed[nlohmann::json::json_pointer(where)] = number;
    try {
      header_from_json_text(changed.dump(), "test");
      ADD_FAILURE() << where << " " << number;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::not_a_session);
    }
  };
  for (const char* where : {"/acquisition", "/frames_per_leg", "/profile/gyro/sign",
                            "/profile/gyro/text/y_column", "/profile/camera/baud"}) {
    refused(where, 3.3e21);
    refused(where, 1.5);
    refused(where, 1LL << 32U);
    refused(where, "1");
  }
  refused("/simulation_seed", -1);
  refused("/time_reference", 9.3e18);
  refused("/time_reference", std::numeric_limits<std::uint64_t>::max());
  EXPECT_NO_THROW(header_from_json_text(sound.dump(), "test"));
}

}  // namespace
}  // namespace thermorig::recording_header
