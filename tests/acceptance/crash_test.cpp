// SPDX-License-Identifier: MIT
// Ends that nobody chose: the program is killed, or loses its disk.
#include <gmock/gmock.h>
#include <sys/mount.h>

#include <csignal>

#include "killed_recording.h"
#include "recorder.h"
#include "support/file_text.h"
#include "support/other_program.h"
#include "thermorig/storage/journal/journal.h"

namespace thermorig::tests {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;

constexpr int long_leg = 40;                     // frames: none of these tests reaches its end
constexpr std::int64_t after_life_us = 500'000;  // of the servo without its program
constexpr double moving_dps = 30.0;

class Killed : public RecorderOnPorts {
 protected:
  /// kill -9 in the first leg; the servo then lives on for a while.
  void kill_in_first_leg() {
    const pid_t process = start_recording(long_leg);
    wait_for_first_leg();
    rig_.let_pass(700'000);
    kill(process, SIGKILL);
    EXPECT_EQ(wait(process).code, 128 + SIGKILL);
    rig_.let_pass(after_life_us);
    rig_.ports().stop();
  }

  /// Every chunk that read() had returned is there, save perhaps the last one of each port; and what lies in
  /// the file is what was delivered, in one piece. What was delivered and is not in the file was thrown away
  /// at opening (head) or waited in the terminal, unread, when the program died (tail).
  void expect_all_that_was_read(const session::Session& session) {
    for (const Device device : all_devices) {
      const Extent extent = extent_of(device, session);
      const auto read = read_from(device);
      if (!read) continue;
      EXPECT_LE(extent.size, read->bytes) << name_of(device);
      EXPECT_GE(extent.size, read->bytes - read->last_bytes) << name_of(device);
    }
  }
};

TEST_F(Killed, LosesNoChunkButPerhapsTheLastAndTheServoComesToRest) {
  kill_in_first_leg();
  const Outcome outcome = run("recover recordings --json");
  ASSERT_THAT(outcome.code, AnyOf(0, 3)) << outcome.err;
  const auto result = outcome.lines().at(0).at(0);
  EXPECT_EQ(result["result"], "recovered");
  EXPECT_EQ(outcome.code == 3, result["bytes_lost"] > 0);  // a torn record: the chunk that was being written
  const session::Session session = only_session();
  EXPECT_EQ(session.state, session::State::recovered);
  EXPECT_FALSE(session.raw.complete);
  EXPECT_EQ(session.frames.size(), result["frames"]);
  expect_all_that_was_read(session);
  EXPECT_GT(rig_.fastest_dps(rig_.last_byte_us() - 100'000, rig_.last_byte_us()), moving_dps);
  expect_rest_after_last_byte();
}

class KilledOnce : public ProgramTest {
 protected:
  void SetUp() override { record_and_be_killed(folder() / "recordings"); }
  std::filesystem::path only_journal() const {
    const auto journals = files(".journal");
    EXPECT_EQ(journals.size(), 1U);
    return journals[0];
  }
};

TEST_F(KilledOnce, RecoversToTheSameFileHoweverOften) {
  const auto journal = only_journal();
  const auto twin = folder() / "twin" / journal.filename();
  std::filesystem::create_directory(twin.parent_path());
  std::filesystem::copy_file(journal, twin);
  EXPECT_THAT(run("recover recordings").code, AnyOf(0, 3));
  EXPECT_THAT(run("recover twin").code, AnyOf(0, 3));
  const auto sessions = files(".h5");
  ASSERT_EQ(sessions.size(), 2U);
  const std::string first = file_text(sessions[0]);
  EXPECT_EQ(first, file_text(sessions[1]));
  EXPECT_EQ(run("recover recordings").code, 0);
  EXPECT_EQ(files(".h5"), sessions);
  EXPECT_EQ(file_text(sessions[0]), first);
}

TEST_F(KilledOnce, RecoversToAFileThatAStockReaderOpens) {
  if (!python_has("h5py")) GTEST_SKIP() << "needs /usr/bin/python3 with h5py: apt-get install python3-h5py";
  EXPECT_THAT(run("recover recordings").code, AnyOf(0, 3));
  const Printed printed = run_script(std::string("acceptance/read_with_h5py.py ") + THERMORIG_SOURCE_DIR +
                                     "/docs/recording_format.md " + files(".h5").at(0).string());
  EXPECT_EQ(printed.code, 0) << printed.text;
}

class Disk : public ProgramTest {};

/// A limit on the size of files stands for a disk that takes no more: the next write fails.
TEST_F(Disk, ThatTakesNoMoreLeavesAJournalToRecover) {
  const Outcome outcome = run_with_files_up_to(
      300,
      "record --world honest --simulated=3 --fast --environment garden --plan quick --frames-per-leg 40");
  EXPECT_EQ(outcome.code, 7) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("try: "));
  const auto journals = files(".journal");
  ASSERT_EQ(journals.size(), 1U);
  EXPECT_THAT(outcome.err, HasSubstr(journals[0].filename().string()));
  EXPECT_GT(std::filesystem::file_size(journals[0]), 290U * 1024);
  EXPECT_THAT(run("recover recordings").code, AnyOf(0, 3));
  const auto sessions = files(".h5");
  ASSERT_EQ(sessions.size(), 1U);
  const session::Session session = session::read_session(sessions[0]);
  EXPECT_EQ(session.state, session::State::recovered);
  EXPECT_GT(session.frames.size(), 50U);
}

/// A small file system of its own, with as much room as is asked for.
class SmallDisk : public ProgramTest {
 protected:
  bool mount_small(const std::string& size) {
    std::filesystem::create_directory(disk());
    mounted_ = mount("none", disk().c_str(), "tmpfs", 0, ("size=" + size).c_str()) == 0;
    return mounted_;
  }
  bool make_room(const std::string& size) const {
    return mount("none", disk().c_str(), "tmpfs", MS_REMOUNT, ("size=" + size).c_str()) == 0;
  }
  void TearDown() override {
    if (mounted_) umount2(disk().c_str(), MNT_DETACH);
  }
  std::filesystem::path disk() const { return folder() / "disk"; }

 private:
  bool mounted_ = false;
};

TEST_F(SmallDisk, IsRefusedBeforeAnythingIsRecorded) {
  if (!mount_small("64k")) GTEST_SKIP() << "needs the right to mount a file system";
  const Outcome outcome =
      run("record --world honest --simulated=3 --fast --environment garden --output disk " + brief_plan);
  EXPECT_EQ(outcome.code, 7) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("try: "));
  EXPECT_TRUE(files(".journal").empty());
  EXPECT_TRUE(files(".h5").empty());
}

TEST_F(SmallDisk, KeepsTheJournalUntilThereIsRoomForTheSession) {
  if (!mount_small("8m")) GTEST_SKIP() << "needs the right to mount a file system";
  record_and_be_killed(folder() / "recordings");
  const auto journal = files(".journal").at(0);
  const auto on_disk = disk() / journal.filename();
  std::filesystem::copy_file(journal, on_disk);
  std::filesystem::resize_file(on_disk, journal::read_journal(on_disk).bytes_read);  // without the reserve
  std::filesystem::remove(journal);
  const auto room_kb = std::filesystem::file_size(on_disk) / 1024 + 16;
  ASSERT_TRUE(make_room(std::to_string(room_kb) + "k"));
  const Outcome full = run("recover disk");
  EXPECT_EQ(full.code, 7) << full.out << full.err;
  EXPECT_THAT(full.out, HasSubstr("free some space"));
  EXPECT_TRUE(files(".h5").empty());
  EXPECT_TRUE(files(".part").empty());
  ASSERT_TRUE(make_room("16m"));
  EXPECT_THAT(run("recover disk").code, AnyOf(0, 3));
  EXPECT_EQ(files(".h5").size(), 1U);
}

}  // namespace
}  // namespace thermorig::tests
