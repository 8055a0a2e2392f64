// SPDX-License-Identifier: MIT
#include "thermorig/storage/journal/journal.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#include <zlib.h>

#include <bit>
#include <csignal>
#include <fstream>
#include <functional>
#include <limits>
#include <random>

#include "../support/paper_estimates.h"
#include "../support/same_row.h"
#include "storage/journal/record.h"
#include "support/format_1_header.h"
#include "support/unusual_profile.h"
#include "thermorig/core/error.h"

namespace thermorig::journal {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::uint8_t>;

RecordingHeader some_header() {
  RecordingHeader header;
  header.uuid = "8d3f2a10-7f6e-4c55-9d0a-2b1c3d4e5f60";
  header.environment = "garden";
  header.acquisition = 3;
  header.title = "Garten, 2. Lauf \"früh\"";
  header.start_time_utc = "2026-07-25T14:35:12.000001Z";
  header.time_reference = host_time_ns(5'000'000'000);
  header.realtime_offset_ns = -12;
  header.simulated = true;
  header.simulation_seed = 18446744073709551615ULL;
  header.profile.name = "bench rig";
  header.profile.camera.link.port = "/dev/ttyUSB7";
  header.profile.camera.checksum = ChecksumPolicy::byte;
  header.profile.gyro.protocol = "text";
  header.profile.gyro.text.rate = {3, -1, 5};
  header.profile.gyro.axis = 0;
  header.profile.gyro.sign = -1;
  header.profile.servo.kind = ServoKind::continuous;
  header.profile.servo.travel_deg = 720.1;
  header.profile.servo.full_rate_dps = 250.5;
  header.plan_toml = "legs = [7.5, -7.5]\n";
  header.frames_per_leg = 57;
  return header;
}

class Journal : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "thermorig_journal_XXXXXX").string();
    ASSERT_NE(::mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override {
    fs::permissions(folder_, fs::perms::owner_all);
    fs::remove_all(folder_);
  }

  fs::path path(const char* name = "one.journal") const { return folder_ / name; }

  Bytes read_file(const fs::path& file) const {
    std::ifstream in(file, std::ios::binary);
    return Bytes(std::istreambuf_iterator<char>(in), {});
  }

  fs::path write_file(const Bytes& bytes) const {
    const fs::path file = path("copy.journal");
    std::ofstream out(file, std::ios::binary | std::ios::trunc);
    out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    return file;
  }

  fs::path folder_;
};

/// One record of every kind; the size of the file after each of them is kept.
struct SmallJournal {
  explicit SmallJournal(const fs::path& path, bool closed = true) {
    JournalWriter writer(path, some_header(), 0);
    const auto mark = [&] { ends.push_back(writer.bytes_written()); };
    mark();
    writer.received(Device::camera, Bytes{1, 2, 3}, host_time_ns(11)), mark();
    writer.received(Device::gyro, Bytes{4}, host_time_ns(12)), mark();
    writer.sent(Device::servo, Bytes{0x7E, 9}, host_time_ns(13)), mark();
    writer.event({host_time_ns(14), EventKind::warning, Device::gyro, "late \n bytes"}), mark();
    writer.leg({7, 2, -7.5, host_time_ns(1), host_time_ns(15), 57, true}), mark();
    writer.received(Device::camera, Bytes{}, host_time_ns(16)), mark();
    writer.received(Device::servo, Bytes{5, 6}, host_time_ns(17)), mark();
    if (closed) {
      writer.close(host_time_ns(18));
      mark();
    }
  }
  std::vector<std::uint64_t> ends;
};

/// Everything that a reader gave, as text, to compare readings with.
std::string summary(const JournalContents& contents) {
  std::string text = std::to_string(contents.records) + "/" + std::to_string(contents.bytes_read) + "/" +
                     std::to_string(contents.bytes_ignored) + "/" +
                     std::to_string(contents.recording.complete);
  const auto stream = [&text](const RawStream& raw) {
    text.append(raw.bytes.begin(), raw.bytes.end());
    for (std::size_t i = 0; i < raw.chunk_count(); ++i)
      text += "," + std::to_string(raw.chunk_end[i]) + "@" + std::to_string(raw.time_ns[i]);
  };
  for (const Device device : all_devices) stream(contents.recording.received[device]);
  for (const Device device : all_devices) stream(contents.recording.sent[device]);
  for (const auto& event : contents.recording.events) text += event.message;
  return text + std::to_string(contents.recording.legs.size());
}

TEST_F(Journal, GivesBackEveryRecord) {
  const SmallJournal small(path());
  const auto [recording, records, bytes_read, bytes_ignored] = read_journal(path());
  EXPECT_EQ(records, 9U);
  EXPECT_EQ(bytes_read, fs::file_size(path()));
  EXPECT_EQ(bytes_ignored, 0U);
  EXPECT_TRUE(recording.complete);
  EXPECT_EQ(recording.end_time, host_time_ns(18));
  const auto& camera = recording.received[Device::camera];
  EXPECT_EQ(camera.bytes, (Bytes{1, 2, 3}));
  EXPECT_THAT(camera.chunk_end, testing::ElementsAre(3, 3));
  EXPECT_THAT(camera.time_ns, testing::ElementsAre(11, 16));
  EXPECT_EQ(recording.received[Device::servo].bytes, (Bytes{5, 6}));
  EXPECT_EQ(recording.sent[Device::servo].bytes, (Bytes{0x7E, 9}));
  ASSERT_EQ(recording.events.size(), 1U);
  EXPECT_EQ(recording.events[0].message, "late \n bytes");
  EXPECT_EQ(recording.events[0].source, Device::gyro);
  ASSERT_EQ(recording.legs.size(), 1U);
  EXPECT_EQ(recording.legs[0].leg, 7);
  EXPECT_EQ(recording.legs[0].rate_dps, -7.5);
  EXPECT_EQ(recording.legs[0].frames, 57);
  EXPECT_TRUE(recording.legs[0].complete);
}

TEST_F(Journal, GivesBackTheWholeHeader) {
  const SmallJournal small(path());
  const auto header = read_journal(path()).recording.header;
  const auto sent = some_header();
  EXPECT_EQ(header.title, sent.title);
  EXPECT_EQ(header.simulation_seed, sent.simulation_seed);
  EXPECT_EQ(header.time_reference, sent.time_reference);
  EXPECT_EQ(header.realtime_offset_ns, sent.realtime_offset_ns);
  EXPECT_EQ(header.profile.camera.checksum, sent.profile.camera.checksum);
  EXPECT_EQ(header.profile.gyro.protocol, sent.profile.gyro.protocol);
  EXPECT_EQ(header.profile.gyro.text.rate, sent.profile.gyro.text.rate);
  EXPECT_EQ(header.profile.gyro.sign, sent.profile.gyro.sign);
  EXPECT_EQ(header.profile.servo.kind, sent.profile.servo.kind);
  EXPECT_EQ(header.profile.servo.travel_deg, sent.profile.servo.travel_deg);
  EXPECT_EQ(header.plan_toml, sent.plan_toml);
}

TEST_F(Journal, GivesBackEveryFieldOfTheProfile) {
  RecordingHeader header = some_header();
  header.profile = tests::unusual_profile();
  JournalWriter(path(), header, 0).close(host_time_ns(18));
  EXPECT_EQ(tests::difference(read_journal(path()).recording.header.profile, header.profile), "");
}

void put_number(Bytes& bytes, std::size_t at, std::uint32_t number) {
  for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<std::uint8_t>(number >> (8 * i));
}

/// The same records behind a header with another text.
Bytes with_header_text(const Bytes& journal, std::uint64_t header_end, const std::string& text) {
  constexpr std::size_t length_at = 24, sum_at = 28, payload_at = 32;
  Bytes bytes(journal.begin(), journal.begin() + payload_at);
  bytes.insert(bytes.end(), text.begin(), text.end());
  put_number(bytes, length_at, static_cast<std::uint32_t>(text.size()));
  const auto sum = ::crc32(::crc32(0, bytes.data(), sum_at), bytes.data() + payload_at,
                           static_cast<unsigned>(text.size()));
  put_number(bytes, sum_at, static_cast<std::uint32_t>(sum));
  bytes.insert(bytes.end(), journal.begin() + static_cast<std::ptrdiff_t>(header_end), journal.end());
  return bytes;
}

TEST_F(Journal, OfTheTimeBeforeSessionFormat2IsRead) {
  RecordingHeader header = some_header();
  header.profile = tests::format_1_profile(tests::unusual_profile());
  const SmallJournal small(path());
  const fs::path old =
      write_file(with_header_text(read_file(path()), small.ends.front(), tests::format_1_header(header)));
  const JournalContents contents = read_journal(old);
  EXPECT_EQ(contents.records, small.ends.size());
  EXPECT_EQ(contents.bytes_ignored, 0U);
  EXPECT_EQ(tests::difference(contents.recording.header.profile, header.profile), "");
  EXPECT_EQ(contents.recording.header.plan_toml, header.plan_toml);
}

TEST_F(Journal, KeepsApartWhatWentToEachDevice) {
  {
    JournalWriter writer(path(), some_header(), 0);
    writer.sent(Device::gyro, Bytes{1, 2}, host_time_ns(13));
    writer.sent(Device::servo, Bytes{3}, host_time_ns(14));
    writer.sent(Device::camera, Bytes{4}, host_time_ns(15));
    writer.sent(Device::gyro, Bytes{5}, host_time_ns(16));
    writer.close(host_time_ns(18));
  }
  const PerDevice<RawStream> sent = read_journal(path()).recording.sent;
  EXPECT_EQ(sent[Device::camera].bytes, (Bytes{4}));
  EXPECT_EQ(sent[Device::gyro].bytes, (Bytes{1, 2, 5}));
  EXPECT_THAT(sent[Device::gyro].time_ns, testing::ElementsAre(13, 16));
  EXPECT_EQ(sent[Device::servo].bytes, (Bytes{3}));
}

TEST_F(Journal, EndsWhereBytesWentToADeviceThatNoRigHas) {
  {
    JournalWriter writer(path(), some_header(), 0);
    writer.sent(Device::servo, Bytes{3}, host_time_ns(14));
    writer.sent(static_cast<Device>(device_count), Bytes{4}, host_time_ns(15));
    writer.close(host_time_ns(18));
  }
  const JournalContents contents = read_journal(path());
  EXPECT_EQ(contents.records, 2U);
  EXPECT_FALSE(contents.recording.complete);
}

TEST_F(Journal, CutAtAnyByteKeepsEveryRecordBeforeTheCut) {
  const SmallJournal small(path());
  const Bytes whole = read_file(path());
  for (std::size_t length = 0; length <= whole.size(); ++length) {
    const fs::path cut =
        write_file(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length)));
    if (length < small.ends.front()) {
      EXPECT_THROW(read_journal(cut), Error) << length;
      continue;
    }
    const auto contents = read_journal(cut);
    const auto kept = std::upper_bound(small.ends.begin(), small.ends.end(), length) - small.ends.begin();
    ASSERT_EQ(contents.records, static_cast<std::uint64_t>(kept)) << length;
    ASSERT_EQ(contents.bytes_read + contents.bytes_ignored, length);
    ASSERT_EQ(contents.recording.complete, length == whole.size());
  }
}

TEST_F(Journal, StopsAtTheFirstFlippedBitAndBelievesNothingAfterIt) {
  const SmallJournal small(path());
  const Bytes whole = read_file(path());
  for (std::size_t bit = 0; bit < whole.size() * 8; bit += 7) {
    Bytes flipped = whole;
    flipped[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
    const fs::path file = write_file(flipped);
    if (bit / 8 < small.ends.front()) {
      EXPECT_THROW(read_journal(file), Error) << bit;
      continue;
    }
    const auto good = std::upper_bound(small.ends.begin(), small.ends.end(), bit / 8) - small.ends.begin();
    ASSERT_EQ(read_journal(file).records, static_cast<std::uint64_t>(good)) << bit;
  }
}

TEST_F(Journal, IgnoresAGarbageTailAndReadsTheSameTwice) {
  const SmallJournal small(path(), false);
  std::mt19937 random(4);
  for (int trial = 0; trial < 100; ++trial) {
    Bytes bytes = read_file(path());
    const std::size_t length = bytes.size();
    for (unsigned i = 0, n = random() % 4096; i < n; ++i)
      bytes.push_back(static_cast<std::uint8_t>(trial % 2 ? random() : 0));
    const fs::path file = write_file(bytes);
    const auto contents = read_journal(file);
    EXPECT_EQ(contents.records, 8U);
    EXPECT_EQ(contents.bytes_ignored, bytes.size() - length);
    EXPECT_EQ(summary(contents), summary(read_journal(file)));
  }
}

TEST_F(Journal, RecordsOfAnotherJournalAreNotTakenForItsOwn) {
  const SmallJournal first(path(), false);
  const SmallJournal second(path("two.journal"));
  Bytes bytes = read_file(path());
  const Bytes other = read_file(path("two.journal"));
  // The end record of the second journal has just the sequence number that the first expects next.
  bytes.insert(bytes.end(), other.begin() + static_cast<std::ptrdiff_t>(first.ends.back()), other.end());
  const auto contents = read_journal(write_file(bytes));
  EXPECT_FALSE(contents.recording.complete);
  EXPECT_EQ(contents.bytes_ignored, other.size() - first.ends.back());
}

TEST_F(Journal, ALengthBeyondTheFileAllocatesNothing) {
  const SmallJournal small(path());
  Bytes bytes = read_file(path());
  const auto length_at = static_cast<std::size_t>(small.ends[0]) + 24;
  bytes[length_at + 2] = 0xFF;  // 16 MB
  EXPECT_EQ(read_journal(write_file(bytes)).records, 1U);
  bytes[length_at + 3] = 0xFF;  // 4 GB
  EXPECT_EQ(read_journal(write_file(bytes)).records, 1U);
}

TEST_F(Journal, IsNeverOverwrittenAndIsPrivate) {
  const SmallJournal small(path());
  struct stat info {};
  ASSERT_EQ(::stat(path().c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777U, 0600U);
  const Bytes before = read_file(path());
  try {
    JournalWriter again(path(), some_header(), 0);
    FAIL() << "an existing journal was opened for writing";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::storage);
    EXPECT_FALSE(error.advice().empty());
  }
  EXPECT_EQ(read_file(path()), before);
}

// Every record's front claims many of the next ones: to check each would take the square of the size.
TEST_F(Journal, ThatIsMadeToBeBusyWithIsLeftAlone) {
  const SmallJournal small(path());
  Bytes front = read_file(path());
  ASSERT_GT(front.size(), 400U);
  front.resize(32);
  front[31] ^= 1U;  // its check sum
  Bytes bytes;
  for (int i = 0; i < 4000; ++i) bytes.insert(bytes.end(), front.begin(), front.end());
  EXPECT_FALSE(holds_nothing(write_file(bytes)));
  EXPECT_TRUE(holds_nothing(write_file(Bytes(bytes.size()))));
}

TEST_F(Journal, FollowsNoSymbolicLink) {
  fs::create_symlink(path("elsewhere"), path("link"));
  EXPECT_THROW(JournalWriter(path("link"), some_header(), 0), Error);
  EXPECT_FALSE(fs::exists(path("elsewhere")));
}

TEST_F(Journal, SaysHowMuchSpaceIsMissingAndLeavesNoFile) {
  try {
    JournalWriter writer(path(), some_header(), std::uint64_t{1} << 60U);
    FAIL() << "an exabyte was reserved";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::storage);
    EXPECT_THAT(error.what_happened(), testing::HasSubstr("MB missing"));
  }
  EXPECT_FALSE(fs::exists(path()));
}

TEST_F(Journal, AFolderThatIsNotThereIsAStorageErrorWithAdvice) {
  try {
    JournalWriter writer(folder_ / "no" / "x.journal", some_header(), 0);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::storage);
    EXPECT_THAT(error.advice(), testing::HasSubstr("--output"));
  }
}

TEST_F(Journal, GivesTheReserveBackWhenItCloses) {
  constexpr std::uint64_t reserve = 8U << 20U;
  JournalWriter writer(path(), some_header(), reserve);
  struct stat info {};
  ASSERT_EQ(::stat(path().c_str(), &info), 0);
  EXPECT_EQ(static_cast<std::uint64_t>(info.st_size), writer.bytes_written());
  writer.close(host_time_ns(1));
  ASSERT_EQ(::stat(path().c_str(), &info), 0);
  EXPECT_LT(static_cast<std::uint64_t>(info.st_blocks) * 512, reserve);
}

/// The file size limit of a child process stands for a full disk: writes fail or are cut short.
int append_until_refused(const fs::path& path) {
  const rlimit limit{20'000, 20'000};
  ::setrlimit(RLIMIT_FSIZE, &limit);
  std::signal(SIGXFSZ, SIG_IGN);
  JournalWriter writer(path, some_header(), 0);
  const Bytes chunk(1544, 0x5A);
  int refused = 0;
  for (int i = 0; i < 20; ++i) try {
      writer.received(Device::camera, chunk, host_time_ns(i));
      if (refused > 0) return 100;  // after a failed write nothing may be appended
    } catch (const Error& error) {
      if (error.code() != ExitCode::storage) return 101;
      ++refused;
    }
  return refused;
}

TEST_F(Journal, AFullDiskIsAStorageErrorAndWhatWasWrittenStaysReadable) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(append_until_refused(path()));
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  const int refused = WEXITSTATUS(status);
  EXPECT_GT(refused, 0);
  EXPECT_LT(refused, 20);
  const auto contents = read_journal(path());
  EXPECT_EQ(contents.records, 1U + 20U - static_cast<unsigned>(refused));
  EXPECT_EQ(contents.bytes_ignored, 0U);
}

TEST_F(Journal, KilledWritersLoseNothingThatAppendReturnedFrom) {
  for (int trial = 0; trial < 10; ++trial) {
    const fs::path file = path(("killed" + std::to_string(trial)).c_str());
    int ends[2];
    ASSERT_EQ(::pipe(ends), 0);
    const pid_t child = ::fork();
    if (child == 0) {
      JournalWriter writer(file, some_header(), 1U << 20U);
      for (std::int32_t i = 1;; ++i) {
        writer.received(Device::gyro, Bytes(11, static_cast<std::uint8_t>(i)), host_time_ns(i));
        if (::write(ends[1], &i, sizeof i) != sizeof i) ::_exit(1);
      }
    }
    ::close(ends[1]);
    std::int32_t acknowledged = 0;
    for (int i = 0; i < 100 + 37 * trial; ++i)
      ASSERT_EQ(::read(ends[0], &acknowledged, sizeof acknowledged), ssize_t{sizeof acknowledged});
    ::kill(child, SIGKILL);
    while (::read(ends[0], &acknowledged, sizeof acknowledged) == ssize_t{sizeof acknowledged}) continue;
    ::close(ends[0]);
    ASSERT_EQ(::waitpid(child, nullptr, 0), child);
    const auto contents = read_journal(file);
    EXPECT_FALSE(contents.recording.complete);
    EXPECT_GE(contents.recording.received[Device::gyro].chunk_count(),
              static_cast<std::size_t>(acknowledged));
  }
}

TEST_F(Journal, OtherFilesAreNotJournals) {
  const fs::path text = write_file(Bytes(100, 'x'));
  EXPECT_FALSE(is_journal(text));
  EXPECT_THROW(read_journal(text), Error);
  EXPECT_FALSE(is_journal(write_file({})));
  EXPECT_THROW(read_journal(folder_), Error);
  EXPECT_THROW(read_journal(path("missing")), Error);
  ASSERT_EQ(::mkfifo(path("fifo").c_str(), 0600), 0);
  EXPECT_THROW(read_journal(path("fifo")), Error);
  const SmallJournal small(path());
  EXPECT_TRUE(is_journal(path()));
}

EstimateRow some_estimate(std::uint32_t index) {
  const float unknown = std::bit_cast<float>(0x7FC01234U);  // a NaN with bits of its own
  EstimateRow row{.frame_index = index,
                  .time = host_time_ns(1'000'000'001),
                  .exposure_begin = host_time_ns(-2),
                  .exposure_end = host_time_ns(3),
                  .arrival = host_time_ns(4'000'000'000'000),
                  .rate_commanded_dps = -40.1F,
                  .reason_bits = 0x1F0F1U,
                  .run = 4'000'000'000U,
                  .leg = 65535,
                  .counted = index % 2 == 1};
  RateEstimate& fusion = row.estimates[of_fusion];
  fusion = {1e-42F, 0.5F, -1e300, 3.0F, EstimateState::starting, EstimateReason::no_rest, {0.25F}};
  fusion.values[3] = unknown;
  row.estimates[of_gyro].rate_dps = unknown;
  row.estimates[of_thermal] = rate_only(-0.0F);
  return row;
}

RecordingHeader live_header() {
  RecordingHeader header = some_header();
  header.estimators = paper_columns;
  return header;
}

TEST_F(Journal, GivesBackTheRowsOfALiveRunBitForBit) {
  JournalWriter writer(path(), live_header(), 0);
  std::vector<EstimateRow> rows;
  for (const std::uint32_t index : {0U, 1U, 5U, 4'294'967'295U}) {
    rows.push_back(some_estimate(index));
    writer.estimate(rows.back());
  }
  writer.close(host_time_ns(9));
  const auto contents = read_journal(path());
  EXPECT_TRUE(contents.recording.complete);
  EXPECT_EQ(contents.recording.header.estimators, paper_columns);
  EXPECT_TRUE(live::same_rows(contents.recording.estimates, rows));
}

/// The bytes of a journal with that header alone, and one record behind it.
Bytes with_record(const Bytes& journal, RecordType type, const Bytes& payload) {
  FrontBytes first;
  std::copy_n(journal.begin(), front_bytes, first.begin());
  const auto header = decode_front(first);
  const std::size_t end = front_bytes + header->length;
  Bytes bytes(journal.begin(), journal.begin() + static_cast<std::ptrdiff_t>(end));
  const RecordFront front{.type = type,
                          .journal_id = header->journal_id,
                          .sequence = 1,
                          .length = static_cast<std::uint32_t>(payload.size())};
  const std::span<const std::uint8_t> part(payload);
  const FrontBytes encoded = encode_front(front, {&part, 1});
  bytes.insert(bytes.end(), encoded.begin(), encoded.end());
  bytes.insert(bytes.end(), payload.begin(), payload.end());
  return bytes;
}

TEST_F(Journal, EndsAtARowOfOtherEstimatorsThanTheHeaderNames) {
  JournalWriter(path(), live_header(), 0).close(host_time_ns(9));
  const Bytes journal = read_file(path());
  for (const std::size_t count : {2U, 3U, 4U}) {
    const Bytes bytes =
        with_record(journal, RecordType::estimates, encode_estimates(some_estimate(3), count));
    const auto contents = read_journal(write_file(bytes));
    EXPECT_EQ(contents.recording.estimates.size(), count == 3 ? 1U : 0U);
    EXPECT_EQ(contents.bytes_ignored > 0, count != 3);
  }
}

TEST_F(Journal, EndsAtARowWhereTheHeaderNamesNoEstimators) {
  JournalWriter(path(), some_header(), 0).close(host_time_ns(9));
  const Bytes row = encode_estimates(some_estimate(3), 0);
  const auto contents = read_journal(write_file(with_record(read_file(path()), RecordType::estimates, row)));
  EXPECT_TRUE(contents.recording.estimates.empty());
  EXPECT_GT(contents.bytes_ignored, 0U);
}

TEST_F(Journal, EndsAtARowWithAStateOrAReasonThatThereIsNot) {
  JournalWriter(path(), live_header(), 0).close(host_time_ns(9));
  const Bytes journal = read_file(path());
  for (const std::size_t place : {51U + 20U, 51U + 21U}) {
    Bytes payload = encode_estimates(some_estimate(3), 3);
    payload[place] = 77;
    const auto contents = read_journal(write_file(with_record(journal, RecordType::estimates, payload)));
    EXPECT_TRUE(contents.recording.estimates.empty());
    EXPECT_GT(contents.bytes_ignored, 0U);
  }
}

/// A row as it was written before format 2 of sessions.
Bytes row_before_format_2() {
  Bytes payload(67);
  const auto put = [&](std::size_t at, auto value) {
    for (std::size_t i = 0; i < sizeof value; ++i)
      payload[at + i] = static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * i));
  };
  put(0, std::uint32_t{12});
  for (const std::size_t at : {4U, 12U, 20U, 28U}) put(at, std::uint64_t{1'000'000'000} + at);
  put(36, std::bit_cast<std::uint32_t>(-40.0F));
  put(40, std::bit_cast<std::uint32_t>(-39.0F));
  put(44, std::bit_cast<std::uint32_t>(-42.0F));
  put(48, std::bit_cast<std::uint32_t>(-41.0F));
  put(52, std::bit_cast<std::uint32_t>(0.75F));
  put(56, std::uint32_t{0x10});
  put(60, std::uint32_t{7});
  put(64, std::uint16_t{9});
  payload[66] = 1;
  return payload;
}

TEST_F(Journal, ReadsTheRowsOfRecordingsOfBeforeFormat2) {
  RecordingHeader header = some_header();
  header.live_model = {
      .name = "best.onnx", .hash = std::string(64, 'a'), .frames = 3, .reduction = 1, .fusion = true};
  JournalWriter(path(), header, 0).close(host_time_ns(9));
  const fs::path old =
      write_file(with_record(read_file(path()), RecordType::estimate, row_before_format_2()));
  const RawRecording recording = read_journal(old).recording;
  EXPECT_EQ(recording.header.estimators, paper_columns);
  const EstimateRow expected = with_rates({.frame_index = 12,
                                           .time = host_time_ns(1'000'000'004),
                                           .exposure_begin = host_time_ns(1'000'000'012),
                                           .exposure_end = host_time_ns(1'000'000'020),
                                           .arrival = host_time_ns(1'000'000'028),
                                           .rate_commanded_dps = -40.0F,
                                           .reason_bits = 0x10,
                                           .run = 7,
                                           .leg = 9,
                                           .counted = true},
                                          -39.0F, -42.0F, -41.0F, 0.75F);
  EXPECT_TRUE(live::same_rows(recording.estimates, {expected}));
}

TEST_F(Journal, ARowOutOfItsOrderEndsTheReading) {
  for (const std::uint32_t second : {3U, 2U}) {
    const fs::path file = path(second == 3U ? "twice.journal" : "back.journal");
    JournalWriter writer(file, live_header(), 0);
    writer.estimate(some_estimate(3));
    writer.estimate(some_estimate(second));
    writer.close(host_time_ns(9));
    const auto contents = read_journal(file);
    EXPECT_FALSE(contents.recording.complete);
    EXPECT_EQ(contents.recording.estimates.size(), 1U);
    EXPECT_GT(contents.bytes_ignored, 0U);
  }
}

// Whoever counts with such a time leaves the clock's range; a record of it has a good CRC all the same.
TEST_F(Journal, ATimeThatNoRecorderCanHaveWrittenEndsTheReading) {
  using Write = std::function<void(JournalWriter&, HostTime)>;
  const std::vector<Write> writes{
      [](JournalWriter& w, HostTime time) { w.received(Device::camera, Bytes{1}, time); },
      [](JournalWriter& w, HostTime time) { w.sent(Device::servo, Bytes{1}, time); },
      [](JournalWriter& w, HostTime time) {
        w.event({time, EventKind::info, std::nullopt, "late"});
      },
      [](JournalWriter& w, HostTime time) {
        w.leg({1, 0, 7.5, time, host_time_ns(15), 57, true});
      },
      [](JournalWriter& w, HostTime time) {
        w.leg({1, 0, 7.5, host_time_ns(15), time, 57, true});
      },
      [](JournalWriter& w, HostTime time) {
        EstimateRow row = some_estimate(4);
        row.arrival = time;
        w.estimate(row);
      },
      [](JournalWriter& w, HostTime time) { w.close(time); }};
  constexpr std::int64_t reference_ns = 5'000'000'000;  // of some_header()
  constexpr std::int64_t farthest_ns = 1'000'000'000'000'000'000;
  const auto records_read = [&](const Write& write, std::int64_t ns) {
    const fs::path file = path("times.journal");
    fs::remove(file);
    {
      JournalWriter writer(file, live_header(), 0);
      writer.received(Device::gyro, Bytes{4}, host_time_ns(12));
      write(writer, host_time_ns(ns));
    }
    const auto contents = read_journal(file);
    EXPECT_EQ(contents.bytes_read + contents.bytes_ignored, fs::file_size(file));
    return contents.records;
  };
  for (std::size_t i = 0; i < writes.size(); ++i) {
    for (const std::int64_t ns :
         {std::numeric_limits<std::int64_t>::min(), std::numeric_limits<std::int64_t>::max(),
          reference_ns - farthest_ns - 1, reference_ns + farthest_ns + 1})
      EXPECT_EQ(records_read(writes[i], ns), 2U) << "record " << i << " at " << ns;
    for (const std::int64_t ns : {reference_ns - farthest_ns, reference_ns + farthest_ns})
      EXPECT_EQ(records_read(writes[i], ns), 3U) << "record " << i << " at " << ns;
  }
}

TEST_F(Journal, KeepsWhichNetworkRan) {
  RecordingHeader header = some_header();
  header.live_model = {"best.onnx", std::string(64, 'a'), 3, 2, true, true, 150.5, "fp16"};
  JournalWriter(path(), header, 0).close(host_time_ns(9));
  const LiveModel read = read_journal(path()).recording.header.live_model;
  EXPECT_EQ(read.name, "best.onnx");
  EXPECT_EQ(read.hash, std::string(64, 'a'));
  EXPECT_EQ(read.frames, 3);
  EXPECT_EQ(read.reduction, 2);
  EXPECT_TRUE(read.fusion);
  EXPECT_TRUE(read.simulated);
  EXPECT_EQ(read.label_scale_dps, 150.5);
  EXPECT_EQ(read.precision, "fp16");
  header.live_model.frames = 1'000'000;
  EXPECT_THROW(JournalWriter(path("two.journal"), header, 0), Error);
  header.live_model.frames = 3;
  header.live_model.label_scale_dps = 0.0;
  EXPECT_THROW(JournalWriter(path("two.journal"), header, 0), Error);
}

TEST_F(Journal, AHeaderThatCouldNotBeReadBackIsRefusedBeforeAnyFileIsMade) {
  RecordingHeader header = some_header();
  header.environment = "../garden";
  EXPECT_THROW(JournalWriter(path(), header, 0), Error);
  header = some_header();
  header.profile.gyro.axis = 3;
  EXPECT_THROW(JournalWriter(path(), header, 0), Error);
  EXPECT_FALSE(fs::exists(path()));
}

}  // namespace
}  // namespace thermorig::journal
