// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include <algorithm>
#include <cstdlib>

#include "synthetic_session.h"
#include "temporary_folder.h"
#include "thermorig/core/count_text.h"
#include "thermorig/core/error.h"
#include "thermorig/storage/session/annotations.h"
#include "thermorig/storage/session/salvage.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::session {
namespace {

using testing::HasSubstr;

/// A session file of which only the first bytes are left.
class CutFile : public InTemporaryFolder {
 protected:
  void SetUp() override {
    InTemporaryFolder::SetUp();
    Annotation note;
    note.made_utc = "2026-11-30T00:00:00Z";
    note.text = "the window was open";
    session_.annotations.push_back(note);
    write_session(path("whole.h5"), session_);
    whole_ = read_file(path("whole.h5"));
  }

  std::filesystem::path cut(std::size_t bytes) const {
    write_file(path("cut.h5"), {whole_.begin(), whole_.begin() + static_cast<std::ptrdiff_t>(bytes)});
    return path("cut.h5");
  }

  Salvaged left_of(std::size_t bytes) const { return salvage(StoredFile(cut(bytes))); }

  Session session_ = SyntheticSession(900, 1).take();
  std::vector<char> whole_;
};

void expect_prefix(const RawStream& part, const RawStream& whole) {
  ASSERT_LE(part.chunk_count(), whole.chunk_count());
  EXPECT_EQ(part.bytes.size(), part.chunk_end.empty() ? 0 : part.chunk_end.back());
  EXPECT_TRUE(std::equal(part.bytes.begin(), part.bytes.end(), whole.bytes.begin()));
  EXPECT_TRUE(std::equal(part.chunk_end.begin(), part.chunk_end.end(), whole.chunk_end.begin()));
  EXPECT_TRUE(std::equal(part.time_ns.begin(), part.time_ns.end(), whole.time_ns.begin()));
}

bool is_whole(const RawStream& part, const RawStream& whole) {
  return part.chunk_count() == whole.chunk_count();
}

TEST_F(CutFile, SaysHowMuchOfItIsThere) {
  for (const std::size_t bytes : {std::size_t{200}, whole_.size() / 2, whole_.size() - 1}) {
    try {
      read_session(cut(bytes));
      ADD_FAILURE() << bytes;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::not_a_session);
      EXPECT_EQ(error.what_happened(), "was cut short: " + count_text(bytes) + " of " +
                                           count_text(whole_.size()) + " bytes are there");
      EXPECT_THAT(error.advice(), HasSubstr("thermorig recover"));
    }
    EXPECT_TRUE(is_cut_short(StoredFile(cut(bytes))));
  }
  EXPECT_FALSE(is_cut_short(StoredFile(path("whole.h5"))));
}

TEST_F(CutFile, HasAllRawBytesInItsFirstPartAndWhatWasSaidOfIt) {
  const RawRecording& raw = session_.raw;
  for (const std::size_t percent : {70U, 85U, 99U}) {
    const Salvaged left = left_of(whole_.size() * percent / 100);
    for (const Device device : all_devices) {
      EXPECT_EQ(left.raw.received[device].bytes, raw.received[device].bytes) << percent;
      EXPECT_EQ(left.raw.sent[device].bytes, raw.sent[device].bytes) << percent;
      EXPECT_TRUE(is_whole(left.raw.received[device], raw.received[device])) << percent;
    }
    EXPECT_EQ(left.raw.events.size(), raw.events.size());
    EXPECT_EQ(left.raw.legs.size(), raw.legs.size());
    EXPECT_EQ(left.raw.header.uuid, raw.header.uuid);
    EXPECT_EQ(left.raw.header.profile.name, raw.header.profile.name);
    EXPECT_EQ(left.annotations, session_.annotations);
    EXPECT_FALSE(left.raw.complete);
    EXPECT_EQ(left.bytes_missing, whole_.size() - whole_.size() * percent / 100);
  }
}

TEST_F(CutFile, GivesOfEachStreamWhatIsThereAndNeverAnythingElse) {
  bool has_part = false;
  for (std::size_t bytes = 100; bytes < whole_.size(); bytes += whole_.size() / 97) {
    try {
      const Salvaged left = left_of(bytes);
      for (const Device device : all_devices) {
        expect_prefix(left.raw.received[device], session_.raw.received[device]);
        expect_prefix(left.raw.sent[device], session_.raw.sent[device]);
      }
      const RawStream& camera = left.raw.received[Device::camera];
      EXPECT_GE(left.raw.end_time, camera.time(camera.chunk_count() - 1)) << bytes;
      EXPECT_LE(left.raw.end_time, session_.raw.end_time) << bytes;
    } catch (const Error& error) {
      has_part = true;
      EXPECT_EQ(error.code(), ExitCode::not_a_session) << bytes;
    }
  }
  EXPECT_TRUE(has_part) << "the first bytes hold no frame";
}

TEST_F(CutFile, ThatClaimsToBeFarLargerIsRefused) {
  std::vector<char> bytes(whole_.begin(), whole_.begin() + 5'000);
  bytes[44] = 3;  // of the stated end: 12 GiB
  write_file(path("cut.h5"), bytes);
  EXPECT_THROW(salvage(StoredFile(path("cut.h5"))), Error);
}

TEST_F(CutFile, IsNoneAfterItWasPackedByAnotherProgram) {
  if (std::system("command -v h5repack >/dev/null") != 0) GTEST_SKIP() << "needs hdf5-tools";
  write_session(path("empty.h5"), SyntheticSession(0, 1).take());
  for (const char* name : {"whole.h5", "empty.h5"}) {  // it fails on a dataset without rows or chunks
    const std::string repack = "h5repack -f GZIP=1 " + path(name).string() + " " + path("packed.h5").string();
    EXPECT_EQ(std::system(repack.c_str()), 0) << name;
  }
}

}  // namespace
}  // namespace thermorig::session
