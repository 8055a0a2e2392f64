// SPDX-License-Identifier: MIT
// Where the rig's profile stands in a session: in groups of its own, and before format 2.0 in the header.
#include <gmock/gmock.h>

#include "equality.h"
#include "format_1_file.h"
#include "replace_session.h"
#include "storage/session/session_image.h"
#include "support/unusual_profile.h"
#include "synthetic_session.h"
#include "temporary_folder.h"
#include "thermorig/core/error.h"
#include "thermorig/storage/session/session.h"
#include "thermorig/storage/session/trial.h"

namespace thermorig::session {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using SessionProfile = InTemporaryFolder;

Session session_with(const RigProfile& profile, std::size_t frames = 20) {
  Session session = synthetic_session(frames);
  session.raw.header.profile = profile;
  return session;
}

std::string why_not_read(const std::filesystem::path& path) {
  try {
    read_session(path);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::not_a_session);
    return error.what_happened();
  }
  return "read";
}

/// "/gyro@default" and all others.
std::vector<std::string> attributes_of(const std::filesystem::path& path) {
  std::vector<std::string> paths;
  for (const StoredAttribute& stored : stored_attributes(EditedFile(path).id()))
    paths.push_back(stored.path());
  return paths;
}

TEST_F(SessionProfile, ComesBackWithEveryField) {
  const RigProfile profile = tests::unusual_profile();
  write_session(path(), session_with(profile));
  EXPECT_EQ(tests::difference(read_session(path()).raw.header.profile, profile), "");
  EXPECT_EQ(tests::difference(read_raw(path()).header.profile, profile), "");
}

TEST_F(SessionProfile, StandsInOnePlace) {
  RigProfile profile;
  profile.camera.link.port = "/dev/the-only-one";
  write_session(path(), session_with(profile));
  std::vector<std::string> places;
  for (const StoredAttribute& stored : stored_attributes(EditedFile(path()).id()))
    for (const std::string& text : stored.texts)
      if (text.find("the-only-one") != std::string::npos) places.push_back(stored.path());
  EXPECT_THAT(places, testing::ElementsAre("/rig/profile/camera@port"));
}

TEST_F(SessionProfile, OfFormat1ComesBackWithEveryField) {
  const Session session = format_1_session(session_with(tests::unusual_profile()));
  write_format_1(path(), session);
  EXPECT_EQ(difference(session, read_session(path())), "");
  EXPECT_EQ(tests::difference(read_session(path()).raw.header.profile, session.raw.header.profile), "");
  EXPECT_THAT(altered_attributes(StoredFile(path())), IsEmpty());
}

TEST_F(SessionProfile, OfFormat1IsMovedWhenTheSessionIsReplaced) {
  const Session session = format_1_session(session_with(tests::unusual_profile()));
  write_format_1(path("old.h5"), session);
  EXPECT_THAT(attributes_of(path("old.h5")), Contains("/gyro@scale"));
  write_session(path("new.h5"), session);
  replace_session(path("old.h5"), read_session(path("old.h5")));
  EXPECT_EQ(attributes_of(path("old.h5")), attributes_of(path("new.h5")));
  EXPECT_TRUE(read_file(path("old.h5")) == read_file(path("new.h5")));
}

TEST_F(SessionProfile, OutOfRangeIsRefusedWithFieldValueAndRange) {
  const auto refused = [&](const char* group, const char* name, auto value) {
    write_unchecked(path(), synthetic_session(3));
    {
      const EditedFile file(path());
      file.replace(group, name, value);
      file.renew_sums();
    }
    return why_not_read(path());
  };
  EXPECT_THAT(refused("/rig/profile/servo", "loop_hz", 1e9),
              HasSubstr("[servo] loop_hz = 1000000000 is out of range: a number from 0.5 to 100"));
  EXPECT_THAT(refused("/rig/profile/gyro", "sign", std::int64_t{0}),
              HasSubstr("[gyro] sign = 0 is out of range"));
  EXPECT_THAT(refused("/rig/profile/camera", "baud", std::int64_t{1} << 40U),
              HasSubstr("[camera] baud = 1099511627776 is out of range: a whole number from 0 to 12000000"));
  EXPECT_THAT(refused("/rig/profile/gyro", "protocol", std::string("witmocion")),
              HasSubstr("did you mean \"witmotion\"?"));
  EXPECT_THAT(refused("/rig/profile/gyro", "scale", std::string("one")), HasSubstr("attribute scale"));
  EXPECT_THAT(refused("/rig/profile/gyro", "scale", std::int64_t{1}), HasSubstr("attribute scale"));
}

TEST_F(SessionProfile, OfANewerMinorVersionIsRead) {
  const Session session = session_with(tests::unusual_profile());
  write_unchecked(path(), session);
  {
    const EditedFile file(path());
    file.replace("/", "format_version", "2.9.0");
    file.replace("/", "scalars_crc32", scalars_crc32(session, header_text(session.raw.header), {2, 9}));
    file.replace("/rig/profile/gyro", "serial_number", std::int64_t{3});
    file.renew_sums();
  }
  EXPECT_EQ(difference(session, read_session(path())), "");
}

TEST_F(SessionProfile, WithoutAFieldThatCameLaterHasItsStandardValue) {
  write_unchecked(path(), session_with(tests::unusual_profile()));
  {
    const EditedFile file(path());
    check(H5Adelete_by_name(file.id(), "/rig/profile/servo", "loop_hz", H5P_DEFAULT), "remove a field");
    file.renew_sums();
  }
  EXPECT_EQ(read_session(path()).raw.header.profile.servo.loop_hz, RigProfile().servo.loop_hz);
}

}  // namespace
}  // namespace thermorig::session
