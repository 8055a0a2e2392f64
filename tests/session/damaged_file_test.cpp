// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include <functional>
#include <limits>

#include "equality.h"
#include "replace_session.h"
#include "synthetic_session.h"
#include "temporary_folder.h"
#include "thermorig/core/error.h"
#include "thermorig/storage/session/session.h"
#include "unchecked_file.h"

namespace thermorig::session {
namespace {

using DamagedSession = InTemporaryFolder;

/// What a damaged file may lead to.
enum Outcome : int { refused, equal, wrong, wrong_error };

Outcome read_and_compare(const std::filesystem::path& path, const Session& truth) {
  try {
    return difference(truth, read_session(path)).empty() ? equal : wrong;
  } catch (const Error& error) {
    return error.code() == ExitCode::not_a_session && !error.what_happened().empty() ? refused : wrong_error;
  }
}

TEST_F(DamagedSession, WithADelayOfTheServoBeyondAnyClockIsRefused) {
  Session session = synthetic_session(20);
  session.sync.servo.delay_s = 1e300;
  write_unchecked(path(), session);
  EXPECT_EQ(read_and_compare(path(), session), refused);
}

TEST_F(DamagedSession, WhoseSamplesAreNotOneAFrameInOrderIsRefused) {
  const Session sound = synthetic_session(20);
  Session twice = sound, longer = sound, shorter = sound;
  twice.samples[7].frame_index = 6;
  longer.samples.push_back(longer.samples.back());
  shorter.samples.pop_back();
  for (const Session& session : {twice, longer, shorter}) {
    write_unchecked(path(), session);
    EXPECT_EQ(read_and_compare(path(), session), refused);
    std::filesystem::remove(path());
  }
}

// Whatever it was made of would be removed otherwise.
TEST_F(DamagedSession, IsNeverWrittenNorPutInThePlaceOfASoundOne) {
  const Session sound = synthetic_session(20);
  Session session = sound;
  session.sync.servo.delay_s = 1e300;
  const auto refusal = [&](auto write) -> std::string {
    try {
      write(path(), session, files::real_disk());
      return "written";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::not_a_session);
      EXPECT_THAT(error.advice(), testing::HasSubstr("still there"));
      return error.what_happened();
    }
  };
  EXPECT_THAT(refusal(write_session),
              testing::HasSubstr("could not be read again: cannot believe the servo"));
  EXPECT_TRUE(std::filesystem::is_empty(folder_));
  write_session(path(), sound);
  EXPECT_THAT(refusal(replace_session), testing::HasSubstr("could not be read again"));
  EXPECT_EQ(difference(sound, read_session(path())), "");
}

TEST_F(DamagedSession, WithTimesThatNoRunLastsIsRefused) {
  constexpr std::int64_t first_ns = std::numeric_limits<std::int64_t>::min();
  constexpr std::int64_t last_ns = std::numeric_limits<std::int64_t>::max();
  const std::vector<std::function<void(RawRecording&)>> damages{
      [&](RawRecording& raw) { raw.received[Device::gyro].time_ns.back() = last_ns; },
      [&](RawRecording& raw) { raw.sent[Device::servo].time_ns.front() = first_ns; },
      [&](RawRecording& raw) { raw.end_time = host_time_ns(last_ns); }};
  for (std::size_t i = 0; i < damages.size(); ++i) {
    Session session = synthetic_session(20);
    damages[i](session.raw);
    const auto file = path(std::to_string(i) + ".h5");
    write_unchecked(file, session);
    try {
      read_raw(file);
      ADD_FAILURE() << "damage " << i;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::not_a_session);
    }
  }
}

TEST_F(DamagedSession, CutAnywhereIsRefused) {
  const Session truth = synthetic_session(20);
  write_session(path("whole.h5"), truth);
  const auto whole = read_file(path("whole.h5"));
  for (std::size_t cut = 0; cut < 60; ++cut) {
    const std::size_t length = cut < 10 ? cut * 7 : whole.size() * (cut - 10) / 50;
    write_file(path(), std::vector<char>(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length)));
    EXPECT_EQ(read_and_compare(path(), truth), refused) << "cut at " << length << " of " << whole.size();
  }
}

TEST_F(DamagedSession, WithBytesBehindItsEndIsRefusedAndSaysHowMany) {
  write_session(path(), synthetic_session(20));
  auto bytes = read_file(path());
  bytes.insert(bytes.end(), {'m', 'o', 'r', 'e'});
  write_file(path(), bytes);
  try {
    read_session(path());
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::not_a_session);
    EXPECT_THAT(error.what_happened(), testing::HasSubstr(" bytes, and 4 more stand behind"));
  }
}

TEST_F(DamagedSession, OtherFilesAreRefusedWithASentence) {
  write_file(path("text.h5"), {'h', 'e', 'l', 'l', 'o'});
  write_file(path("empty.h5"), {});
  ASSERT_EQ(::mkfifo(path("fifo.h5").c_str(), 0600), 0);
  for (const auto& file : {path("text.h5"), path("empty.h5"), path("fifo.h5"), path("missing.h5"), folder_})
    try {
      read_session(file);
      FAIL() << file;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::not_a_session);
      EXPECT_FALSE(error.advice().empty());
    }
}

TEST_F(DamagedSession, AFolderIsNotCalledDamaged) {
  try {
    read_session(folder_);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.what_happened(), "this is a folder, not a session");
    EXPECT_EQ(error.advice(), "name the session files (.h5) in it, or below it");
  }
}

}  // namespace
}  // namespace thermorig::session
