// SPDX-License-Identifier: MIT
#include "thermorig/rig/recording/session_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "simulated_bus.h"
#include "thermorig/core/error.h"

namespace thermorig::rig {
namespace {

using ::testing::HasSubstr;

void touch(const std::filesystem::path& path) {
  std::ofstream(path) << "x";
}

TEST(SessionFile, NamesCarryEnvironmentNumberAndTime) {
  const test::TemporaryFolder folder;
  const SessionFile file = FolderLock(folder.path(), "dining-place").next("20260725T143512Z");
  EXPECT_EQ(file.acquisition, 1);
  EXPECT_EQ(file.session, folder.path() / "dining-place/dining-place_acq-01_20260725T143512Z.h5");
  EXPECT_EQ(file.journal, folder.path() / "dining-place/dining-place_acq-01_20260725T143512Z.journal");
  EXPECT_EQ(session_of(file.journal), file.session);
}

TEST(SessionFile, NumbersAreNeverUsedTwice) {
  const test::TemporaryFolder folder;
  const FolderLock lock(folder.path(), "garden");
  touch(folder.path() / "garden/garden_acq-02_20200101T000000Z.h5");
  EXPECT_EQ(lock.next("20260725T143512Z").acquisition, 3);
  touch(folder.path() / "garden/garden_acq-17_20200101T000000Z.journal");
  EXPECT_EQ(lock.next("20260725T143512Z").acquisition, 18);
  touch(folder.path() / "garden/garden_acq-121_20200101T000000Z.log");
  EXPECT_THAT(lock.next("20260725T143512Z").session.string(), HasSubstr("garden_acq-122_"));
}

TEST(SessionFile, OtherFilesDoNotCount) {
  const test::TemporaryFolder folder;
  const FolderLock lock(folder.path(), "garden");
  for (const char* name : {"garden_acq-", "garden_acq-x_1.h5", "garden_acq-9", "kitchen_acq-44_1.h5",
                           "garden_acq--5_1.h5", "garden_acq-99999999999999999999_1.h5"})
    touch(folder.path() / "garden" / name);
  EXPECT_EQ(lock.next("20260725T143512Z").acquisition, 1);
}

TEST(SessionFile, EnvironmentsAreCheckedBeforeAFolderIsMade) {
  const test::TemporaryFolder folder;
  for (const char* bad :
       {"", "a/b", "../x", "Kitchen", "dining place", "a.b", "012345678901234567890123456789012"}) {
    try {
      const FolderLock lock(folder.path(), bad);
      ADD_FAILURE() << bad;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::bad_usage);
      EXPECT_THAT(error.what(), HasSubstr("a-z, 0-9 and '-'"));
    }
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  EXPECT_NO_THROW(check_environment("lab-2"));
}

TEST(SessionFile, AFileInTheWayIsAStorageError) {
  const test::TemporaryFolder folder;
  touch(folder.path() / "out");
  try {
    const FolderLock lock(folder.path() / "out", "garden");
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::storage);
    EXPECT_THAT(error.what(), HasSubstr("cannot be written"));
  }
}

TEST(SessionFile, TimesAreMadeCompact) {
  EXPECT_EQ(compact_utc("2026-07-25T14:35:12.123456Z"), "20260725T143512Z");
  EXPECT_EQ(compact_utc("2026-07-25T14:35:12Z"), "20260725T143512Z");
}

}  // namespace
}  // namespace thermorig::rig
