// SPDX-License-Identifier: MIT
#include "rig/recording/disk_watch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "memory_disk.h"
#include "recorded_session.h"
#include "rig/recording/journal_sync.h"

namespace thermorig::storage_test {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;
using ::testing::Not;

class LateSyncs : public testing::Test {
 protected:
  LateSyncs() {
    disk_.make_folder("/rec");
    RecordingHeader header;
    header.environment = "garden";
    header.uuid = "00000000-0000-4000-8000-000000000000";
    writer_.emplace("/rec/r.journal", header, 1'000'000, disk_);
    watch_.emplace(*writer_, milliseconds(125));
    watch_->look(HostTime{}, {});
  }

  /// What is said of a sync that lasted so long, after the oldest byte had waited so long in all.
  std::string said(HostDuration waited, HostDuration lasted) {
    now_ += std::chrono::minutes(1);
    const auto events = watch_->look(now_, rig::LateSync{waited, lasted});
    return events.empty() ? "" : events.front().message;
  }

 private:
  MemoryDisk disk_ = new_disk();
  std::optional<journal::JournalWriter> writer_;
  std::optional<rig::DiskWatch> watch_;
  HostTime now_{};
};

TEST_F(LateSyncs, AreOfASlowDiskWhereTheSyncTookLong) {
  const std::string text = said(milliseconds(234), milliseconds(130));
  EXPECT_THAT(text, HasSubstr("the disk is slow: a sync took 130 ms (limit 125)"));
  EXPECT_THAT(text, HasSubstr("data of 234 ms was not on the disk"));
}

TEST_F(LateSyncs, AreOfABusyComputerWhereItDidNot) {
  EXPECT_EQ(said(milliseconds(139), milliseconds(1)), "") << "the disk is fine, and the processor came soon";
  EXPECT_EQ(said(milliseconds(183), milliseconds(76)), "") << "`doctor` calls such a disk fine as well";
  const std::string text = said(milliseconds(400), milliseconds(1));
  EXPECT_THAT(text, HasSubstr("this computer is busy"));
  EXPECT_THAT(text, Not(HasSubstr("slow")));
}

TEST(ExpectedSync, IsNotForgottenAtOnce) {
  HostDuration expected = rig::expected_sync({}, milliseconds(64));
  EXPECT_EQ(expected, milliseconds(64));
  expected = rig::expected_sync(expected, milliseconds(1));
  EXPECT_EQ(expected, milliseconds(62));
  for (int i = 0; i < 150; ++i) expected = rig::expected_sync(expected, milliseconds(1));
  EXPECT_LT(expected, milliseconds(2));
}

}  // namespace
}  // namespace thermorig::storage_test
