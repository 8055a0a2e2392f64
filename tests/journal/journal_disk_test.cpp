// SPDX-License-Identifier: MIT
// What a journal says of a disk that fails, and of records that are whole but say nothing that a recorder
// writes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <fstream>

#include "failing_disk.h"
#include "storage/journal/record.h"
#include "thermorig/core/error.h"
#include "thermorig/storage/journal/journal.h"

namespace thermorig::journal {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::uint8_t>;
using testing::HasSubstr;

RecordingHeader small_header() {
  RecordingHeader header;
  header.uuid = "8d3f2a10-7f6e-4c55-9d0a-2b1c3d4e5f60";
  header.environment = "garden";
  header.acquisition = 1;
  header.start_time_utc = "2026-07-25T14:35:12.000001Z";
  return header;
}

class JournalDisk : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "thermorig_journal_XXXXXX").string();
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path path() const { return folder_ / "one.journal"; }

  /// What opening a journal on the disk is refused with.
  Error refusal() {
    return error_of([&] { JournalWriter(path(), small_header(), 1000, disk_); });
  }

  template <typename Call>
  static Error error_of(Call call) {
    try {
      call();
    } catch (const Error& error) {
      return error;
    }
    ADD_FAILURE() << "nothing was thrown";
    return Error(ExitCode::failed, "", "", "");
  }

  fs::path folder_;
  FailingDisk disk_;
};

TEST_F(JournalDisk, EachRefusalOfTheDiskHasItsAdvice) {
  const std::pair<int, const char*> advised[] = {{ENOSPC, "free some space"},
                                                 {EDQUOT, "free some space"},
                                                 {EROFS, "a folder that you may write to"},
                                                 {EACCES, "a folder that you may write to"},
                                                 {EEXIST, "never overwritten"},
                                                 {ENOTDIR, "create the folder first"},
                                                 {EIO, "check the disk"}};
  for (const auto& [number, advice] : advised) {
    disk_.errors = {{"create", number}};
    const Error error = refusal();
    EXPECT_EQ(error.code(), ExitCode::storage);
    EXPECT_THAT(error.what_happened(), HasSubstr("cannot create the journal"));
    EXPECT_THAT(error.advice(), HasSubstr(advice)) << number;
  }
}

TEST_F(JournalDisk, AJournalThatCannotBeginLeavesNoFile) {
  const std::pair<const char*, const char*> steps[] = {{"reserve", "cannot reserve space"},
                                                       {"append", "cannot write"},
                                                       {"sync", "cannot sync"},
                                                       {"sync_folder", "cannot sync the folder"}};
  for (const auto& [call, what] : steps) {
    disk_.errors = {{call, EIO}};
    const Error error = refusal();
    EXPECT_EQ(error.code(), ExitCode::storage);
    EXPECT_THAT(error.what_happened(), HasSubstr(what));
    EXPECT_FALSE(fs::exists(path())) << call;
  }
}

TEST_F(JournalDisk, ADiskWithoutRoomForTheReserveSaysSo) {
  for (const int number : {ENOSPC, EDQUOT, EFBIG}) {
    disk_.errors = {{"reserve", number}};
    EXPECT_THAT(refusal().what_happened(), HasSubstr("not enough space")) << number;
    EXPECT_FALSE(fs::exists(path()));
  }
  disk_.errors.clear();
  JournalWriter writer(path(), small_header(), 1000, disk_);
  EXPECT_TRUE(writer.can_reserve());
  disk_.errors = {{"reserve", ENOSPC}};
  EXPECT_FALSE(writer.reserve(100'000));
  EXPECT_EQ(writer.reserved(), 1000U);
  EXPECT_TRUE(writer.reserve(500));  // it has so much
}

TEST_F(JournalDisk, WhereSpaceCannotBeReservedTheWriterKnowsIt) {
  for (const int number : {EOPNOTSUPP, ENOSYS}) {
    disk_.errors = {{"reserve", number}};
    JournalWriter writer(path(), small_header(), 1000, disk_);
    EXPECT_FALSE(writer.can_reserve());
    EXPECT_EQ(writer.reserved(), 1000U);
    fs::remove(path());
  }
}

TEST_F(JournalDisk, FreeSpaceThatIsUnknownKeepsNobodyFromRecording) {
  disk_.errors = {{"free_bytes", EIO}};
  JournalWriter writer(path(), small_header(), 1000, disk_);
  EXPECT_EQ(writer.free_bytes(), UINT64_MAX);
  disk_.errors.clear();
  EXPECT_LT(writer.free_bytes(), UINT64_MAX);
}

TEST_F(JournalDisk, ADiskThatTakesPartsOfARecordGetsTheRest) {
  disk_.most_at_once = 7;
  {
    JournalWriter writer(path(), small_header(), 0, disk_);
    writer.received(Device::camera, Bytes(100, 5), host_time_ns(1));
    writer.close(host_time_ns(2));
    EXPECT_EQ(writer.bytes_written(), fs::file_size(path()));
  }
  const auto contents = read_journal(path());
  EXPECT_TRUE(contents.recording.complete);
  EXPECT_EQ(contents.recording.received[Device::camera].bytes, Bytes(100, 5));
}

TEST_F(JournalDisk, ADiskThatTakesNothingIsFull) {
  JournalWriter writer(path(), small_header(), 0, disk_);
  disk_.most_at_once = 0;
  const Error error = error_of([&] { writer.sent(Device::servo, Bytes{1}, host_time_ns(1)); });
  EXPECT_THAT(error.what_happened(), HasSubstr("No space left"));
  EXPECT_THAT(error.advice(), HasSubstr("free some space"));
}

TEST_F(JournalDisk, AfterAFailureNothingIsWrittenAndTheFirstOneIsTold) {
  for (const char* call : {"append", "sync"}) {
    JournalWriter writer(path(), small_header(), 0, disk_);
    const auto size = writer.bytes_written();
    const auto strike = [&] {
      call == std::string("sync") ? writer.sync() : writer.sent(Device::servo, Bytes{1}, host_time_ns(1));
    };
    disk_.errors = {{call, EIO}};
    const Error first = error_of(strike);
    disk_.errors = {{call, ENOSPC}};
    EXPECT_EQ(error_of(strike).what_happened(), first.what_happened());
    disk_.errors.clear();  // although it is well again
    EXPECT_EQ(error_of([&] { writer.sync(); }).what_happened(), first.what_happened());
    EXPECT_EQ(error_of([&] { writer.close(host_time_ns(2)); }).what_happened(), first.what_happened());
    EXPECT_EQ(writer.bytes_written(), size);
    EXPECT_EQ(fs::file_size(path()), size);
    EXPECT_EQ(read_journal(path()).records, 1U);
    fs::remove(path());
  }
}

TEST_F(JournalDisk, AJournalThatCannotBeClosedIsToldSo) {
  for (const char* call : {"truncate", "close"}) {
    JournalWriter writer(path(), small_header(), 0, disk_);
    disk_.errors = {{call, EIO}};
    EXPECT_THAT(error_of([&] { writer.close(host_time_ns(2)); }).what_happened(), HasSubstr("cannot close"));
    disk_.errors.clear();
    EXPECT_TRUE(read_journal(path()).recording.complete);  // its bytes are there all the same
    fs::remove(path());
  }
}

TEST_F(JournalDisk, AClosedJournalTakesNothingMore) {
  JournalWriter writer(path(), small_header(), 0, disk_);
  writer.close(host_time_ns(2));
  const Error error = error_of([&] { writer.sent(Device::servo, Bytes{1}, host_time_ns(3)); });
  EXPECT_EQ(error.code(), ExitCode::storage);
  EXPECT_THAT(error.what_happened(), HasSubstr("the journal is closed"));
}

TEST_F(JournalDisk, AWriterThatMovesGoesOn) {
  JournalWriter first(path(), small_header(), 0, disk_);
  JournalWriter second = std::move(first);
  second.sent(Device::servo, Bytes{1}, host_time_ns(1));
  JournalWriter other(folder_ / "two.journal", small_header(), 0, disk_);
  other = std::move(second);
  other.close(host_time_ns(2));
  EXPECT_EQ(read_journal(path()).records, 3U);
}

TEST_F(JournalDisk, ADiskThatCannotReadIsNotAJournalThatEnds) {
  JournalWriter(path(), small_header(), 0).close(host_time_ns(2));
  for (const char* call : {"open", "size", "read"}) {
    disk_.errors = {{call, EIO}};
    const Error error = error_of([&] { read_journal(path(), disk_); });
    EXPECT_EQ(error.code(), ExitCode::storage) << call;
    EXPECT_THAT(error.advice(), HasSubstr("the journal is still there"));
    disk_.errors = {{call, EACCES}};
    EXPECT_EQ(error_of([&] { read_journal(path(), disk_); }).code(), ExitCode::no_permission) << call;
    disk_.errors = {{call, ENXIO}};
    EXPECT_EQ(error_of([&] { read_journal(path(), disk_); }).code(), ExitCode::not_a_session) << call;
  }
}

TEST_F(JournalDisk, AJournalThatBecomesShorterWhileItIsReadIsToldSo) {
  std::ofstream(path(), std::ios::binary) << std::string(100, '\0');
  disk_.phantom_bytes = 10;
  const Error error = error_of([&] { holds_nothing(path(), disk_); });
  EXPECT_THAT(error.what_happened(), HasSubstr("becomes shorter"));
}

TEST_F(JournalDisk, AHeaderLongerThanARecordIsRefusedBeforeAnyFileIsMade) {
  RecordingHeader header = small_header();
  header.plan_toml = std::string(payload_max_bytes, '#');
  const Error error = error_of([&] { JournalWriter(path(), header, 0, disk_); });
  EXPECT_EQ(error.code(), ExitCode::bad_usage);
  EXPECT_THAT(error.what_happened(), HasSubstr("too long"));
  EXPECT_FALSE(fs::exists(path()));
}

/// A record with a sound check sum that follows the header of the journal `begin`.
Bytes behind(const Bytes& begin, RecordType type, std::uint8_t device, const Bytes& payload) {
  FrontBytes header_front{};
  std::copy_n(begin.begin(), front_bytes, header_front.begin());
  const RecordFront front{type, device, decode_front(header_front)->journal_id, 1,
                          static_cast<std::uint32_t>(payload.size())};
  const std::span<const std::uint8_t> part(payload);
  const FrontBytes bytes = encode_front(front, {&part, 1});
  Bytes journal = begin;
  journal.insert(journal.end(), bytes.begin(), bytes.end());
  journal.insert(journal.end(), payload.begin(), payload.end());
  return journal;
}

TEST_F(JournalDisk, SoundRecordsThatNoRecorderWritesEndTheReading) {
  { const JournalWriter writer(path(), small_header(), 0); }
  std::ifstream in(path(), std::ios::binary);
  const Bytes begin(std::istreambuf_iterator<char>(in), {});
  const Bytes header_text(begin.begin() + front_bytes, begin.end());
  Bytes event(10);
  event[8] = 255;  // no kind
  Bytes source(10);
  source[9] = 77;  // no device
  struct Hostile {
    const char* what;
    RecordType type;
    std::uint8_t device;
    Bytes payload;
  };
  const Hostile records[] = {{"a second header", RecordType::header, 0, header_text},
                             {"another device", RecordType::received, 200, Bytes(12)},
                             {"no time", RecordType::received, 0, Bytes(7)},
                             {"no time", RecordType::sent, 0, Bytes(7)},
                             {"no time", RecordType::event, 0, Bytes(7)},
                             {"another kind of event", RecordType::event, 0, event},
                             {"another source of an event", RecordType::event, 0, source},
                             {"half a leg", RecordType::leg, 0, Bytes(9)},
                             {"half an estimate", RecordType::estimate, 0, Bytes(66)},
                             {"no time", RecordType::end, 0, Bytes(7)}};
  for (const auto& [what, type, device, payload] : records) {
    const Bytes journal = behind(begin, type, device, payload);
    std::ofstream(path(), std::ios::binary)
        .write(reinterpret_cast<const char*>(journal.data()), static_cast<std::streamsize>(journal.size()));
    const auto contents = read_journal(path());
    EXPECT_EQ(contents.records, 1U) << what;
    EXPECT_EQ(contents.bytes_ignored, front_bytes + payload.size()) << what;
    EXPECT_FALSE(contents.recording.complete) << what;
    EXPECT_TRUE(contents.recording.events.empty() && contents.recording.legs.empty()) << what;
  }
}

}  // namespace
}  // namespace thermorig::journal
