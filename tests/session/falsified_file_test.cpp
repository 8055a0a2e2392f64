// SPDX-License-Identifier: MIT
// Sound HDF5 that is no sound session: each is refused, in a sentence that says what of.
#include <gmock/gmock.h>

#include "storage/session/session_image.h"
#include "storage/session/stored_attributes.h"
#include "storage/session/trial.h"
#include "support/other_program.h"
#include "synthetic_session.h"
#include "temporary_folder.h"
#include "thermorig/core/error.h"
#include "thermorig/storage/session/session.h"
#include "thermorig/storage/session/trial.h"

namespace thermorig::session {
namespace {

using FalsifiedSession = InTemporaryFolder;

std::string refusal_of(const std::filesystem::path& path) {
  try {
    require_readable(StoredFile(path));
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::not_a_session) << path;
    EXPECT_EQ(error.where(), path.string());
    return error.what_happened();
  }
  return "read";
}

TEST_F(FalsifiedSession, IsRefusedAndSaysWhatIsWrong) {
  if (!tests::python_has("h5py"))
    GTEST_SKIP() << "needs /usr/bin/python3 with h5py: apt-get install python3-h5py";
  write_session(path("whole.h5"), synthetic_live_session(20));
  EXPECT_EQ(refusal_of(path("whole.h5")), "read");
  const tests::Printed output =
      tests::run_script("session/falsify.py " + path("whole.h5").string() + " " + folder_.string());
  ASSERT_EQ(output.code, 0) << output.text;
  const std::pair<const char*, const char*> refusals[] = {
      {"another_format", "not a thermorig session"},
      {"no_format", "not a thermorig session"},
      {"another_version", "is a session of format version 3.0.0, and this program reads versions 1 to 2"},
      {"no_licence", "an attribute `license`"},
      {"another_state", "the state asleep"},
      {"attribute", "the attributes: they differ from their checksum"},
      {"older_version", "its header cannot be read: key 'profile' not found"},
      {"newer_minor", "the attributes: they differ from their checksum"},
      {"no_sums", "/quality/attribute_crc32"},
      {"fewer_sums", "/quality/attribute_crc32: its text differs from its checksum"},
      {"quality_speed", "/quality/speed: its values differ from its checksum"},
      {"quality_frames", "/quality/speed_frames: its values differ from its checksum"},
      {"quality_valid", "/quality/speed_valid: its values differ from its checksum"},
      {"profile_value", "/rig/profile/gyro@scale: it differs from its checksum"},
      {"profile_text", "/rig/profile/servo@kind: it differs from its checksum"},
      {"profile_field", "/rig/profile/camera@mirrored: it differs from its checksum"},
      {"profile_table", "/rig/profile/gyro"},
      {"profile", "/rig/profile"},
      {"plan_toml", "/rig/plan_toml: its text differs from its checksum"},
      {"command_time", "/servo/command_time: its values differ from its checksum"},
      {"command_text", "/servo/command_text: its text differs from its checksum"},
      {"value", "/gyro/rate: its values differ from its checksum"},
      {"text", "/events/message: its text differs from its checksum"},
      {"fixed_text", "the type or the shape of /events/message"},
      {"type", "the type or the shape of /gyro/rate"},
      {"rows", "the type or the shape of /gyro/rate"},
      {"axis", "the size of /gyro/time"},
      {"layout", "the layout of /gyro/rate"},
      {"filter", "the filters of /gyro/rate"},
      {"chunks", "the chunks of /gyro/rate"},
      {"chunk_ends", "the chunks of /raw/camera"},
      {"frame_number", "/samples/frame"},
      {"soft_link", "a link at /gyro/rate"},
      {"external_link", "a link at /gyro/rate"},
      {"external", "data outside the file at /gyro/rate"}};
  for (const auto& [kind, sentence] : refusals)
    EXPECT_THAT(refusal_of(path(std::string(kind) + ".h5")), testing::HasSubstr(sentence)) << kind;
  // Nothing is made of these, but people look at them.
  const std::pair<const char*, const char*> altered[] = {
      {"altered_number", "/@simulated"},        {"altered_count", "/environment@acquisition_number"},
      {"altered_text", "/quality@verdict"},     {"altered_array", "/camera@axes"},
      {"altered_units", "/gyro/rate@units"},    {"altered_type", "/quality@frames"},
      {"removed", "/servo/state@flag_meanings"}};
  for (const auto& [kind, attribute] : altered)
    EXPECT_THAT(altered_attributes(StoredFile(path(std::string(kind) + ".h5"))),
                testing::ElementsAre(attribute))
        << kind;
  EXPECT_THAT(altered_attributes(StoredFile(path("added.h5"))), testing::IsEmpty());
}

TEST_F(FalsifiedSession, NamesEveryAttributeThatIsMissing) {
  const SessionImage image = build_image(synthetic_live_session(20), 1);
  const auto all = stored_attributes(image.file.get());
  EXPECT_GT(all.size(), 500U);
  EXPECT_THAT(altered_attributes(all, attribute_sums(all)), testing::IsEmpty());
  const auto missing = altered_attributes({}, attribute_sums(all));
  EXPECT_EQ(missing.size(), all.size() - 1);  // the licence may be stated later
  EXPECT_THAT(missing, testing::Not(testing::Contains("/@license")));
  for (const char* text : {"x", "1234567 /a@b\n", "12345678 /a@b", "1234567g /a@b\n", "12345678\n"})
    EXPECT_THROW(altered_attributes(all, text), Hdf5Failure) << text;
}

}  // namespace
}  // namespace thermorig::session
