// SPDX-License-Identifier: MIT
// Sound HDF5 that is no sound session: each is refused, in a sentence that says what of.
#include <gmock/gmock.h>

#include "session_trial.h"
#include "support/other_program.h"
#include "synthetic_session.h"
#include "temporary_folder.h"
#include "thermorig/core/error.h"
#include "thermorig/session/session.h"

namespace thermorig::session {
namespace {

using FalsifiedSession = InTemporaryFolder;

std::string refusal_of(const std::filesystem::path& path) {
  try {
    read_for_nothing(SealedCopy(path));
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
      {"another_version", "is a session of format version 2.0.0"},
      {"no_licence", "an attribute `license`"},
      {"another_state", "the state asleep"},
      {"attribute", "the attributes: they differ from their checksum"},
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
}

}  // namespace
}  // namespace thermorig::session
