// SPDX-License-Identifier: MIT
#include "thermorig/io/files/descriptor.h"

#include <gtest/gtest.h>
#include <linux/magic.h>
#include <sys/stat.h>
#include <sys/statfs.h>
#include <unistd.h>

#include "session/temporary_folder.h"

namespace thermorig::files {
namespace {

class UnlinkedFile : public session::InTemporaryFolder {};

TEST_F(UnlinkedFile, HasRoomAndNoName) {
  const int file = open_unlinked(path(), 1U << 20U);
  ASSERT_GE(file, 0);
  struct stat info {};
  ASSERT_EQ(::fstat(file, &info), 0);
  EXPECT_EQ(info.st_nlink, 0U);
  EXPECT_EQ(info.st_size, 1 << 20);
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
  ::close(file);
}

TEST_F(UnlinkedFile, IsNeverInMemory) {
  const int file = open_unlinked("/dev/shm/session.h5", 1U << 20U);
  if (file < 0) return;  // there is no other disk
  struct statfs disk {};
  ASSERT_EQ(::fstatfs(file, &disk), 0);
  EXPECT_NE(disk.f_type, TMPFS_MAGIC);
  ::close(file);
}

TEST_F(UnlinkedFile, IsNotMadeWhereThereIsNoRoom) {
  EXPECT_EQ(open_unlinked(path(), std::uint64_t{1} << 60U), -1);
}

}  // namespace
}  // namespace thermorig::files
