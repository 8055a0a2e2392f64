// SPDX-License-Identifier: MIT
#include "thermorig/storage/recording_header/profile_fields.h"

#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <set>
#include <sstream>

#include "support/unusual_profile.h"

namespace thermorig::recording_header {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Stands for a value of any type while members are counted.
struct Anything {
  template <typename Type>
  operator Type() const;
};

/// How many members a structure has: as many values as can stand between its braces.
template <typename Structure, typename... Values>
constexpr std::size_t member_count() {
  if constexpr (requires { Structure{Values{}..., Anything{}}; })
    return member_count<Structure, Values..., Anything>();
  else
    return sizeof...(Values);
}

std::size_t fields_of(const std::string& table) {
  const auto& fields = profile_fields();
  return static_cast<std::size_t>(std::count_if(
      fields.begin(), fields.end(), [&](const ProfileField& field) { return field.table == table; }));
}

TEST(ProfileFields, HaveALineForEachMemberOfTheProfile) {
  constexpr std::size_t link = member_count<PortProfile>();
  EXPECT_EQ(fields_of(""), member_count<RigProfile>() - 4);  // camera, gyro, servo and encoder are tables
  EXPECT_EQ(fields_of("camera"), member_count<CameraProfile>() - 1 + link);
  EXPECT_EQ(fields_of("gyro"), member_count<GyroProfile>() - 3 + link);    // link, text, settings
  EXPECT_EQ(fields_of("gyro.text"), member_count<TextColumns>() - 1 + 3);  // columns of three rates
  EXPECT_EQ(fields_of("servo"), member_count<ServoProfile>() - 1 + link);
  EXPECT_EQ(fields_of("encoder"), member_count<EncoderProfile>());
}

TEST(ProfileFields, AreEachAnotherMember) {
  const RigProfile profile = tests::unusual_profile();
  std::set<std::string> names;
  std::size_t index = 0;
  for_each_field(profile, [&](const ProfileField& field, const FieldValue& value) {
    const std::string name = field.table + "." + field.name;
    EXPECT_TRUE(names.insert(name).second) << name << " stands there twice";
    EXPECT_EQ(value, tests::unusual_value(field, index++)) << name << " was changed by another field";
    const bool has_choice = field.words.size() != 1 && field.name != "sketch";
    EXPECT_EQ(value != field.standard, has_choice) << name;
  });
  EXPECT_EQ(problem_of(profile), std::nullopt);
}

TEST(ProfileFields, OfTheStandardProfileAreAllowed) {
  EXPECT_EQ(problem_of(RigProfile()), std::nullopt);
}

std::string problem_text(const RigProfile& profile) {
  const auto problem = problem_of(profile);
  return problem ? problem->text() : "";
}

TEST(ProfileFields, OutOfRangeAreNamedWithTheirValueAndTheRange) {
  for (const ProfileField& field : profile_fields()) {
    if (!std::holds_alternative<double>(field.standard)) continue;
    for (const double wrong : {std::nextafter(field.min, -1e9), std::nextafter(field.max, 1e9), 1e300,
                               std::numeric_limits<double>::quiet_NaN()}) {
      RigProfile profile;
      field.set(profile, wrong);
      EXPECT_THAT(problem_text(profile),
                  HasSubstr(fmt::format("[{}] {} = {} is out of range: a number from {} to {}", field.table,
                                        field.name, wrong, field.min, field.max)));
    }
  }
}

TEST(ProfileFields, ThatCountAreNamedLikewise) {
  RigProfile profile;
  profile.camera.link.baud = 12'000'001;
  EXPECT_EQ(problem_text(profile),
            "[camera] baud = 12000001 is out of range: a whole number from 0 to 12000000");
  profile = {};
  profile.gyro.text.rate[1] = 64;
  EXPECT_THAT(problem_text(profile), HasSubstr("[gyro.text] y_column = 64 is out of range"));
  profile = {};
  profile.gyro.sign = 0;
  EXPECT_EQ(problem_text(profile), "[gyro] sign = 0 is out of range: 1 or -1");
}

TEST(ProfileFields, OfTextAreNamedWithWhatIsAllowed) {
  RigProfile profile;
  profile.gyro.axis = 3;
  EXPECT_EQ(problem_text(profile), "[gyro] axis = \"3\" is not known: one of: x, y, z");
  profile = {};
  profile.servo.scale_measured_utc = "yesterday";
  EXPECT_THAT(problem_text(profile), HasSubstr("[servo] scale_measured_utc = \"yesterday\" is not a date"));
  profile = {};
  profile.camera.model = std::string("two\0parts", 9);
  EXPECT_THAT(problem_text(profile), HasSubstr("[camera] model holds a zero byte"));
}

TEST(ProfileFields, ThatDoNotGoTogetherAreRefused) {
  RigProfile profile;
  profile.servo.pulse_min_us = profile.servo.pulse_max_us;
  EXPECT_THAT(problem_text(profile), HasSubstr("pulse_min_us is not below pulse_max_us"));
  profile = {};
  profile.servo.kind = ServoKind::continuous;
  EXPECT_THAT(problem_text(profile), HasSubstr("a continuous servo needs full_rate_dps"));
  profile = {};
  profile.servo.travel_deg = 4.5;
  EXPECT_THAT(problem_text(profile), HasSubstr("the margins leave no travel"));
}

/// The rows of docs/profile.md.
std::string table_of(const ProfileField& field) {
  const auto text_of = [](const FieldValue& value) {
    if (const auto* const text = std::get_if<std::string>(&value)) return "\"" + *text + "\"";
    return std::visit([](const auto& plain) { return fmt::format("{}", plain); }, value);
  };
  std::string allowed = field.max > field.min ? fmt::format("{} to {}", field.min, field.max) : "";
  if (field.is_date) allowed = "date or empty";
  if (std::holds_alternative<bool>(field.standard)) allowed = "true, false";
  for (const std::string& word : field.words) allowed += (allowed.empty() ? "" : ", ") + word;
  return fmt::format("| `{}` | {} | {} | `{}` | {} |\n", field.name, field.unit,
                     allowed.empty() ? "text" : allowed, text_of(field.standard), field.help);
}

std::string tables_for_people() {
  std::string text, table = "none";
  const auto add = [&](const ProfileField& field) {
    if (field.table != table)
      text += fmt::format(
          "\n## {}\n\n| key | unit | allowed | standard | meaning |\n| --- | --- | --- | --- | --- |\n",
          field.table.empty() ? "Above all tables" : "`[" + field.table + "]`");
    table = field.table;
    text += table_of(field);
  };
  for (const ProfileField& field : profile_fields()) add(field);
  for (const ProfileField& field : profile_fields())
    if (field.name == "protocol")
      for (const std::string& protocol : field.words)
        for (const ProfileField& setting : setting_fields(protocol)) add(setting);
  return text;
}

TEST(ProfileFields, AreThoseOfTheDocuments) {
  std::ifstream file(THERMORIG_SOURCE_DIR "/docs/profile.md");
  std::stringstream page;
  page << file.rdbuf();
  EXPECT_THAT(page.str(), HasSubstr(tables_for_people()))
      << "docs/profile.md should have, from its first heading of the second level on:\n"
      << tables_for_people();
}

}  // namespace
}  // namespace thermorig::recording_header
