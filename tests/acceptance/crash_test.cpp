// SPDX-License-Identifier: MIT
// Ends that nobody chose: the program is killed, frozen, or loses its disk.
#include <gmock/gmock.h>
#include <sys/mount.h>
#include <sys/resource.h>

#include <csignal>
#include <random>
#include <thread>

#include "growing_journal.h"
#include "recorder.h"
#include "support/file_text.h"
#include "support/other_program.h"
#include "thermorig/journal/journal.h"

namespace thermorig::tests {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;

constexpr int long_leg = 40;                     // frames: none of these tests reaches its end
constexpr std::int64_t after_life_us = 500'000;  // of the servo without its program
constexpr std::uint8_t raw_stop = 0x21;          // protocols/servo_link.md
constexpr double moving_dps = 30.0;

class Killed : public RecorderOnPorts, public testing::WithParamInterface<unsigned> {
 protected:
  /// kill -9 at a seeded instant of the first leg; the servo then lives on for a while.
  void kill_in_first_leg() {
    const pid_t process = start_recording(long_leg);
    wait_for_first_leg();
    std::mt19937 random(GetParam());
    rig_.let_pass(150'000 + static_cast<std::int64_t>(random() % 1'200'000));
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
      const Stretch stretch = stretch_of(device, session);
      const auto read = read_from(device);
      if (!read) continue;
      EXPECT_LE(stretch.size, read->bytes) << name_of(device);
      EXPECT_GE(stretch.size, read->bytes - read->last_bytes) << name_of(device);
    }
  }
};

INSTANTIATE_TEST_SUITE_P(Instants, Killed, testing::Values(1U, 2U, 3U));

TEST_P(Killed, LosesNoChunkButPerhapsTheLastAndTheServoComesToRest) {
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

class KilledOnce : public RecorderOnPorts {
 protected:
  void SetUp() override {
    const pid_t process = start_recording(long_leg);
    wait_for_first_leg();
    kill(process, SIGKILL);
    EXPECT_EQ(wait(process).code, 128 + SIGKILL);
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

class Frozen : public RecorderOnPorts {};

TEST_F(Frozen, StopsTheServoByItsWatchdogAndDrivesTheLegAgain) {
  const pid_t process = start_recording(6);
  wait_for_first_leg();
  rig_.let_pass(200'000);
  kill(process, SIGSTOP);
  rig_.let_pass(1'000'000);
  kill(process, SIGCONT);
  const Outcome outcome = wait(process);
  rig_.ports().stop();
  EXPECT_THAT(outcome.code, AnyOf(0, 3)) << outcome.out << outcome.err;
  const session::Session session = only_session();
  EXPECT_EQ(session.state, session::State::complete);
  EXPECT_THAT(messages_of(session.raw, EventKind::servo_fault), testing::Contains(HasSubstr("watchdog")));
  EXPECT_FALSE(messages_of(session.raw, EventKind::leg_repeated).empty());
  const auto& legs = session.raw.legs;
  ASSERT_GE(legs.size(), 3U);
  EXPECT_FALSE(legs[0].complete);
  EXPECT_EQ(legs[0].step, 0);
  EXPECT_TRUE(std::any_of(legs.begin(), legs.end(), [](const LegRecord& leg) {
    return leg.step == 0 && leg.complete && leg.leg > 1 && leg.frames >= 6;
  }));
  // In the silence: moving before it, at rest 300 ms into it.
  const auto& received = rig_.line().received;
  const auto silence = std::adjacent_find(received.begin(), received.end(), [](const auto& a, const auto& b) {
    return b.time_us - a.time_us > 700'000;
  });
  ASSERT_NE(silence, received.end());
  EXPECT_GT(rig_.fastest_dps(silence->time_us - 100'000, silence->time_us), moving_dps);
  EXPECT_LT(rig_.fastest_dps(silence->time_us + 301'000, (silence + 1)->time_us), 1.0);
}

class Disk : public RecorderOnPorts {};

/// A limit on the size of files stands for a disk that takes no more: the next write fails.
TEST_F(Disk, ThatTakesNoMoreStopsTheServoAndLeavesAJournalToRecover) {
  const pid_t process = start_recording(long_leg);
  wait_for_first_leg();
  rig_.let_pass(300'000);
  const std::uint64_t kept =
      journal::read_journal(only_journal()).recording.received[Device::camera].bytes.size();
  const rlimit limit{20'000, 20'000};  // less than the journal has, more than the program's output
  ASSERT_EQ(prlimit(process, RLIMIT_FSIZE, &limit, nullptr), 0);
  const Outcome outcome = wait(process);
  rig_.let_pass(after_life_us);
  rig_.ports().stop();
  EXPECT_EQ(outcome.code, 7) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("try: "));
  EXPECT_THAT(outcome.err, HasSubstr(only_journal().filename().string()));
  EXPECT_EQ(rig_.line().received.back().value, raw_stop);
  expect_rest_after_last_byte();
  EXPECT_THAT(run("recover recordings").code, AnyOf(0, 3));
  EXPECT_GE(only_session().raw.received[Device::camera].bytes.size(), kept);
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
  const Outcome outcome = run("record --simulated=3 --fast --environment garden --output disk " + brief_plan);
  EXPECT_EQ(outcome.code, 7) << outcome.out << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("try: "));
  EXPECT_TRUE(files(".journal").empty());
  EXPECT_TRUE(files(".h5").empty());
}

TEST_F(SmallDisk, KeepsTheJournalUntilThereIsRoomForTheSession) {
  if (!mount_small("8m")) GTEST_SKIP() << "needs the right to mount a file system";
  const pid_t process = start({"record", "--simulated=3", "--fast", "--environment", "garden"});
  const auto written = [this]() -> std::uint64_t {
    const auto journals = files(".journal");
    const auto contents = journals.empty() ? std::nullopt : growing_journal(journals[0]);
    return contents ? contents->bytes_read : 0;
  };
  while (written() < 400'000) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  kill(process, SIGKILL);
  EXPECT_EQ(wait(process).code, 128 + SIGKILL);
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
