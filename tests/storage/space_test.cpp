// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cerrno>
#include <limits>
#include <new>
#include <utility>

#include "judge.h"
#include "rig/recording/disk_watch.h"
#include "thermorig/core/error.h"
#include "thermorig/io/files/part_file.h"
#include "thermorig/rig/recording/finalise.h"
#include "thermorig/rig/sweep/plan.h"
#include "thermorig/sensors/wire/device_bytes.h"
#include "thermorig/storage/journal/journal.h"

namespace thermorig::storage_test {
namespace {

using rig::RecoveryKind;
using ::testing::HasSubstr;

constexpr int frames = 60;

const RecordedSession& session() {
  static const RecordedSession recorded = record_session(frames);
  return recorded;
}

std::string journal_on(MemoryDisk& disk) {
  for (const auto& [path, bytes] : disk.after_end().files)
    if (path.ends_with(".journal")) return path;
  return {};
}

TEST(Space, IsLookedForBeforeAnythingIsRecorded) {
  MemoryDisk disk = new_disk(1U << 20U);
  HostTime clock{};
  const RecordedAgain again = record_again(session(), disk, &clock);
  EXPECT_EQ(again.code, ExitCode::storage);
  EXPECT_EQ(again.steps, 0U);
  EXPECT_THAT(again.error, HasSubstr("MB missing"));
  EXPECT_TRUE(disk.after_end().files.empty());
}

TEST(Space, IsRefusedOneByteBelowWhatADryRunAsksFor) {
  const rig::RecordingOptions& options = session().options;
  const std::uint64_t needed = rig::expected_recording_bytes(options.plan, options.profile);
  HostTime clock{};
  MemoryDisk small = new_disk(needed - 1);
  EXPECT_EQ(record_again(session(), small, &clock).steps, 0U);
  MemoryDisk enough = new_disk(needed);
  EXPECT_TRUE(record_again(session(), enough, &clock).announced);
}

/// Another program fills the disk two seconds into the recording.
class Filled : public testing::Test {
 protected:
  void SetUp() override {
    rig::RecordingOptions options = session().options;
    options.disk = &disk_;
    rig::Recording recording(options, HostTime{}, [](Device, std::span<const std::uint8_t>) {});
    HostTime now{};
    for (const RecordedSession::Step& at : session().steps) {
      now = at.now;
      for (const Chunk& chunk : at.chunks) recording.received(chunk.device, chunk.bytes, chunk.arrived);
      recording.tick(now);
      if (filler_.empty() && to_s(now - HostTime{}) > 2.0) fill();
    }
    try {
      rig::conclude(recording, now);
    } catch (const Error& error) {
      refusal_ = error;
    }
  }

  void fill() {
    filler_ = "/rec/filler";
    const auto file = disk_.create(filler_, 0600).value;
    const std::uint64_t free = disk_.free_bytes("/rec").value;
    EXPECT_EQ(disk_.reserve(file, free - 1000), 0);
  }

  MemoryDisk disk_ = new_disk(64U << 20U);
  std::string filler_;
  std::optional<Error> refusal_;
};

TEST_F(Filled, DiskLetsTheRecordingGoOnInItsReserveAndIsSaid) {
  const RawRecording raw = journal::read_journal(journal_on(disk_), disk_).recording;
  EXPECT_TRUE(raw.complete);
  EXPECT_TRUE(std::any_of(raw.events.begin(), raw.events.end(), [](const RecordingEvent& event) {
    return event.kind == EventKind::warning && event.message.find("nearly full") != std::string::npos;
  }));
}

TEST_F(Filled, DiskKeepsTheJournalUntilThereIsRoomForTheSession) {
  ASSERT_TRUE(refusal_);
  EXPECT_EQ(refusal_->code(), ExitCode::storage);
  EXPECT_THAT(refusal_->advice(), HasSubstr("thermorig recover"));
  const auto refused = rig::recover(output_folder, disk_);
  ASSERT_EQ(refused.size(), 1U);
  EXPECT_EQ(refused[0].kind, RecoveryKind::failed);
  EXPECT_EQ(refused[0].code, ExitCode::storage);
  EXPECT_NE(journal_on(disk_), "");
  disk_.remove(filler_);
  const auto results = rig::recover(output_folder, disk_);
  ASSERT_EQ(results.size(), 1U);
  EXPECT_EQ(results[0].kind, RecoveryKind::made);
  EXPECT_EQ(results[0].state, session::State::complete);
  EXPECT_EQ(journal_on(disk_), "");
}

MemoryDisk disk_with_journal(const Bytes& bytes) {
  return MemoryDisk(
      {.files = {{"/rec/a.journal", std::make_shared<const Bytes>(bytes)}}, .folders = {"/", "/rec"}});
}

TEST(EmptyJournal, IsSaidAndRemoved) {
  for (const std::size_t size : {std::size_t{0}, std::size_t{5000}}) {
    MemoryDisk disk = disk_with_journal(Bytes(size));
    const auto results = rig::recover(output_folder, disk);
    ASSERT_EQ(results.size(), 1U);
    EXPECT_EQ(results[0].kind, RecoveryKind::empty);
    EXPECT_THAT(results[0].message, HasSubstr("its program ended before it recorded"));
    EXPECT_EQ(journal_on(disk), "");
    EXPECT_TRUE(rig::recover(output_folder, disk).empty());
  }
}

TEST(DamagedHeader, OfAJournalWithGoodRecordsIsAFailureAndTheJournalStays) {
  MemoryDisk disk = new_disk();
  for (std::size_t k = 0; k < 200; ++k) apply(disk, session().calls[k]);
  Bytes bytes = *disk.after_end().files.begin()->second;
  bytes[40] ^= std::byte{1};
  MemoryDisk damaged = disk_with_journal(bytes);
  const auto results = rig::recover(output_folder, damaged);
  ASSERT_EQ(results.size(), 1U);
  EXPECT_EQ(results[0].kind, RecoveryKind::failed);
  EXPECT_EQ(*damaged.after_end().files.at("/rec/a.journal"), bytes);
}

TEST(Recovery, OfOneJournalThatTheDiskDoesNotGiveDoesNotKeepItFromTheOthers) {
  MemoryDisk disk = new_disk();
  for (std::size_t k = 0; k < 200; ++k) apply(disk, session().calls[k]);
  const auto bytes = disk.after_end().files.begin()->second;
  MemoryDisk two({.files = {{"/rec/a.journal", bytes}, {"/rec/b.journal", bytes}}, .folders = {"/", "/rec"}});
  // The first read is of the first journal.
  FaultDisk counted(two);
  counted.keep_calls(nullptr);
  MemoryDisk again(
      {.files = {{"/rec/a.journal", bytes}, {"/rec/b.journal", bytes}}, .folders = {"/", "/rec"}});
  rig::recover(output_folder, counted);
  const auto first_read = std::find_if(counted.calls().begin(), counted.calls().end(),
                                       [](const Call& call) { return call.kind == CallKind::read; });
  FaultDisk failing(again, Fault{FaultKind::io_error,
                                 static_cast<std::size_t>(first_read - counted.calls().begin()), false});
  const auto results = rig::recover(output_folder, failing);
  ASSERT_EQ(results.size(), 2U);
  EXPECT_EQ(results[0].kind, RecoveryKind::failed);
  EXPECT_EQ(results[0].code, ExitCode::storage);
  EXPECT_EQ(results[1].kind, RecoveryKind::made);
  EXPECT_TRUE(again.after_end().files.contains("/rec/b.h5"));
  EXPECT_FALSE(again.after_end().files.contains("/rec/a.h5"));
}

std::shared_ptr<const Bytes> abandoned_journal() {
  MemoryDisk disk = new_disk();
  for (std::size_t k = 0; k < 200; ++k) apply(disk, session().calls[k]);
  return disk.after_end().files.begin()->second;
}

/// A disk of which one thing is odd.
class OddDisk : public MemoryDisk {
 public:
  using MemoryDisk::MemoryDisk;
  std::string unreadable_folder;   // EACCES
  std::string finished_meanwhile;  // a journal that goes when it is opened to be locked
  bool has_locks = true;
  bool memory_ends = false;  // at the first read
  bool loses_ends = false;   // reads of a journal end early by some bytes

  files::Answer<std::vector<files::FolderEntry>> list(const Path& folder) override {
    if (folder == unreadable_folder) return {{}, EACCES};
    return MemoryDisk::list(folder);
  }
  files::Answer<files::OpenFile> open_to_lock(const Path& path) override {
    if (path == finished_meanwhile) remove(path);
    return MemoryDisk::open_to_lock(path);
  }
  int lock(files::OpenFile file, Wait wait) override {
    return has_locks ? MemoryDisk::lock(file, wait) : ENOLCK;
  }
  int reserve(files::OpenFile, std::uint64_t) override { return EOPNOTSUPP; }
  files::Answer<std::size_t> read(files::OpenFile file, std::uint64_t offset,
                                  std::span<std::byte> out) override {
    if (std::exchange(memory_ends, false)) throw std::bad_alloc();
    auto answer = MemoryDisk::read(file, offset, out);
    if (std::exchange(loses_ends, false) && answer.value > 0) out[answer.value - 1] ^= std::byte{1};
    return answer;
  }
};

DiskImage two_journals() {
  return {.files = {{"/rec/a.journal", abandoned_journal()}, {"/rec/b.journal", abandoned_journal()}},
          .folders = {"/", "/rec", "/rec/lost+found"}};
}

TEST(Recovery, GoesOnBesideAFolderThatCannotBeRead) {
  OddDisk disk(two_journals());
  disk.unreadable_folder = "/rec/lost+found";
  const auto results = rig::recover(output_folder, disk);
  ASSERT_EQ(results.size(), 3U);
  EXPECT_EQ(results[0].kind, RecoveryKind::made);
  EXPECT_EQ(results[1].kind, RecoveryKind::made);
  EXPECT_EQ(results[2].kind, RecoveryKind::failed);
  EXPECT_EQ(results[2].source, "/rec/lost+found");
  EXPECT_EQ(results[2].code, ExitCode::storage);
}

TEST(Recovery, PassesOverAJournalThatItsRecorderFinishedMeanwhile) {
  OddDisk disk(two_journals());
  disk.finished_meanwhile = "/rec/a.journal";
  const auto results = rig::recover(output_folder, disk);
  ASSERT_EQ(results.size(), 1U);
  EXPECT_EQ(results[0].source, "/rec/b.journal");
  EXPECT_EQ(results[0].kind, RecoveryKind::made);
}

TEST(Recovery, WithoutMemoryForOneJournalGoesOnWithTheOthers) {
  OddDisk disk(two_journals());
  disk.memory_ends = true;
  const auto results = rig::recover(output_folder, disk);
  ASSERT_EQ(results.size(), 2U);
  EXPECT_EQ(results[0].code, ExitCode::failed);
  EXPECT_THAT(results[0].message, HasSubstr("memory"));
  EXPECT_EQ(results[1].kind, RecoveryKind::made);
}

TEST(Recovery, KeepsAJournalWithoutEndWhereNobodyKnowsWhetherItIsLocked) {
  OddDisk disk(two_journals());
  disk.has_locks = false;
  const auto results = rig::recover(output_folder, disk);
  ASSERT_EQ(results.size(), 2U);
  EXPECT_EQ(results[0].kind, RecoveryKind::made);
  EXPECT_TRUE(disk.after_end().files.contains("/rec/a.journal"));
  EXPECT_TRUE(disk.after_end().files.contains("/rec/a.h5"));
}

std::string closed_journal(MemoryDisk& disk) {
  const std::string path = "/rec/c.journal";
  disk.make_folder("/rec");
  journal::JournalWriter writer(path, session().raw.header, 0, disk);
  for (int i = 0; i < 3; ++i)
    writer.event({session().raw.header.time_reference, EventKind::info, std::nullopt, "said"});
  writer.close(session().raw.header.time_reference);
  return path;
}

/// All records of it are sound; what they hold may not be.
template <typename Write>
MemoryDisk disk_with_records(Write write) {
  MemoryDisk disk(new_disk().after_end());
  disk.make_folder("/rec");
  journal::JournalWriter writer("/rec/t.journal", session().raw.header, 0, disk);
  writer.event({session().raw.header.time_reference, EventKind::info, std::nullopt, "said"});
  write(writer);
  return disk;
}

TEST(Recovery, KeepsAJournalThatHoldsATimeWhichNoRecorderCanHaveWritten) {
  for (const std::int64_t ns :
       {std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::max()}) {
    MemoryDisk disks[] = {
        disk_with_records([&](journal::JournalWriter& writer) { writer.close(host_time_ns(ns)); }),
        disk_with_records([&](journal::JournalWriter& writer) {
          writer.received(Device::camera, wire::camera_frame({}), host_time_ns(ns));
          writer.close(host_time_ns(ns));
        })};
    for (MemoryDisk& disk : disks) {
      const auto results = rig::recover(output_folder, disk);
      ASSERT_EQ(results.size(), 1U);
      EXPECT_EQ(results[0].kind, RecoveryKind::made);
      EXPECT_EQ(results[0].state, session::State::recovered);
      EXPECT_GT(results[0].bytes_ignored, 0U);
      EXPECT_NE(journal_on(disk), "");
      // What inspect does with it.
      EXPECT_EQ(rig::recover("/rec/t.h5", disk)[0].kind, RecoveryKind::already_there);
    }
  }
}

// A frame of the very first moment that a journal may hold was exposed before it: no reader takes that.
MemoryDisk disk_with_an_unreadable_recording() {
  return disk_with_records([](journal::JournalWriter& writer) {
    const HostTime earliest = session().raw.header.time_reference - from_s(farthest_time_s);
    for (int i = 0; i < 3; ++i)
      writer.received(Device::camera, wire::camera_frame({}), earliest + std::chrono::milliseconds(125 * i));
    writer.close(earliest + std::chrono::seconds(1));
  });
}

TEST(Recovery, KeepsAJournalWhoseSessionItsOwnReadersRefuse) {
  MemoryDisk disk = disk_with_an_unreadable_recording();
  for (int run = 0; run < 2; ++run) {  // and says the same again
    const auto results = rig::recover(output_folder, disk);
    ASSERT_EQ(results.size(), 1U);
    EXPECT_EQ(results[0].kind, RecoveryKind::failed);
    EXPECT_EQ(results[0].code, ExitCode::not_a_session);
    EXPECT_THAT(results[0].message, HasSubstr("could not be read again: cannot believe a time"));
    EXPECT_EQ(journal_on(disk), "/rec/t.journal");
    EXPECT_EQ(disk.after_end().files.size(), 1U);  // neither a session nor a part of one
  }
}

TEST(Finalise, KeepsAJournalWhoseSessionItsOwnReadersRefuse) {
  MemoryDisk disk = disk_with_an_unreadable_recording();
  EXPECT_THROW(rig::finalise("/rec/t.journal", "/rec/t.h5", disk), Error);
  EXPECT_EQ(journal_on(disk), "/rec/t.journal");
  EXPECT_EQ(disk.after_end().files.size(), 1U);
}

TEST(Finalise, RetiresAJournalThatIsWholeInTheSession) {
  OddDisk disk(new_disk().after_end());
  const std::string journal = closed_journal(disk);
  const rig::Finalised made = rig::finalise(journal, "/rec/c.h5", disk);
  EXPECT_TRUE(made.is_retired);
  EXPECT_FALSE(disk.after_end().files.contains(journal));
}

TEST(Finalise, KeepsAJournalThatIsNotReadBackWhole) {
  OddDisk disk(new_disk().after_end());
  const std::string journal = closed_journal(disk);
  disk.loses_ends = true;
  const rig::Finalised made = rig::finalise(journal, "/rec/c.h5", disk);
  EXPECT_FALSE(made.is_retired);
  EXPECT_GT(made.bytes_ignored, 0U);
  EXPECT_EQ(made.session.state, session::State::recovered);
  EXPECT_TRUE(disk.after_end().files.contains(journal));
  EXPECT_TRUE(disk.after_end().files.contains("/rec/c.h5"));
}

TEST(Reserve, ThatTheFileSystemCannotGiveIsSaidAndItsSpaceWatched) {
  constexpr std::uint64_t expected = 10'000'000;
  OddDisk disk(new_disk().after_end(), 12'000'000);  // enough for the recording, or for its session
  disk.make_folder("/rec");
  journal::JournalWriter writer("/rec/r.journal", session().raw.header, expected, disk);
  rig::DiskWatch watch(writer, {});
  const auto said = watch.look(HostTime{}, {});
  ASSERT_EQ(said.size(), 2U);
  EXPECT_THAT(said[0].message, HasSubstr("cannot reserve"));
  EXPECT_THAT(said[1].message, HasSubstr("the rest of the recording needs up to 15.0 MB"));
}

TEST(JournalThatFailed, SaysAgainWhatHappenedFirst) {
  MemoryDisk disk = new_disk(100'000);
  disk.make_folder("/rec");
  journal::JournalWriter writer("/rec/r.journal", session().raw.header, 0, disk);
  const auto failure = [&] {
    try {
      for (int i = 0; i < 200; ++i) writer.received(Device::camera, std::vector<std::uint8_t>(1000), {});
    } catch (const Error& error) {
      return error.what_happened();
    }
    return std::string();
  };
  const std::string first = failure();
  EXPECT_THAT(first, HasSubstr("No space left"));
  EXPECT_EQ(failure(), first);
}

TEST(PartFile, OfAKilledProgramOfTheSameNumberIsInNobodysWay) {
  MemoryDisk disk = new_disk();
  disk.make_folder("/rec");
  const std::string left = files::part_path_of("/rec/x.h5");
  disk.close(disk.create(left, 0644).value);
  files::PartFile part("/rec/x.h5", "the session", files::usual_advice, disk);
  EXPECT_THROW(files::PartFile("/rec/x.h5", "the session", files::usual_advice, disk), Error);  // is written
  part.publish();
  EXPECT_FALSE(disk.after_end().files.contains(left));
  EXPECT_TRUE(disk.after_end().files.contains("/rec/x.h5"));
}

}  // namespace
}  // namespace thermorig::storage_test
