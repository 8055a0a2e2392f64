// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "equality.h"
#include "replace_session.h"
#include "storage/session/session_image.h"
#include "support/as_nobody.h"
#include "support/stored_bytes.h"
#include "synthetic_session.h"
#include "temporary_folder.h"
#include "thermorig/core/error.h"
#include "thermorig/storage/session/session.h"
#include "unchecked_file.h"

namespace thermorig::session {
namespace {

namespace fs = std::filesystem;
using SessionFile = InTemporaryFolder;

std::size_t files_in(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST_F(SessionFile, GivesBackEverythingThatWasWritten) {
  const Session session = synthetic_session(170);
  write_session(path(), session);
  EXPECT_EQ(difference(session, read_session(path())), "");
  EXPECT_EQ(difference(session.raw, read_raw(path())), "");
  EXPECT_EQ(files_in(folder_), 1U) << "a temporary file was left behind";
}

TEST_F(SessionFile, GivesBackTheRowsOfALiveRunBitForBit) {
  const Session session = synthetic_live_session(170);
  write_session(path(), session);
  EXPECT_EQ(difference(session, read_session(path())), "");
  const RawRecording raw = read_raw(path());
  EXPECT_EQ(difference(session.raw, raw), "");
  EXPECT_EQ(raw.estimates.size(), 85U);
  EXPECT_EQ(raw.header.live_model.name, "best.onnx");
  EXPECT_EQ(raw.header.live_model.hash, std::string(64, 'a'));
}

TEST_F(SessionFile, KeepsWhatWentToEachDevice) {
  Session session = synthetic_session(20);
  session.raw.sent[Device::gyro].append(std::array<std::uint8_t, 3>{0xFD, 33, 0}, host_time_ns(5));
  session.raw.sent[Device::camera].append(std::array<std::uint8_t, 1>{0xA5}, host_time_ns(6));
  write_session(path(), session);
  EXPECT_EQ(difference(session.raw, read_raw(path())), "");
}

TEST_F(SessionFile, HasNoGroupForADeviceThatNothingWentTo) {
  write_session(path(), synthetic_session(20));
  const Handle file(H5Fopen(path().c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), "open it");
  EXPECT_GT(H5Lexists(file.get(), "/raw/sent", H5P_DEFAULT), 0);
  EXPECT_EQ(H5Lexists(file.get(), "/raw/sent_gyro", H5P_DEFAULT), 0);
  EXPECT_EQ(H5Lexists(file.get(), "/raw/sent_camera", H5P_DEFAULT), 0);
}

TEST_F(SessionFile, WithRowsOfALiveRunOutOfOrderIsRefused) {
  Session session = synthetic_live_session(20);
  std::swap(session.raw.estimates[3], session.raw.estimates[4]);
  write_unchecked(path(), session);
  EXPECT_THROW(read_session(path()), Error);
}

TEST_F(SessionFile, HoldsARecordingInWhichNothingCame) {
  Session session = synthetic_session(0);
  session.state = State::partial;
  session.raw.complete = false;
  session.sync.gyro.decay_per_s = 0.05;
  write_session(path(), session);
  EXPECT_EQ(difference(session, read_session(path())), "");
}

TEST_F(SessionFile, WhatIsNotKnownStaysNotKnown) {
  Session session = synthetic_session(30);
  session.sync.gyro = {};
  session.sync.servo = {};
  write_session(path(), session);
  const SyncReport sync = read_session(path()).sync;
  EXPECT_TRUE(std::isnan(sync.gyro.noise_dps));
  EXPECT_TRUE(std::isnan(sync.servo.residual_dps));
  EXPECT_EQ(difference(sync, session.sync), "");
}

TEST_F(SessionFile, KeepsTimesToTheNanosecondAfterAWeek) {
  Session session = synthetic_session(3);
  const HostDuration week = std::chrono::hours(24 * 7);
  for (auto& sample : session.samples) sample.time += week + HostDuration(1);
  write_session(path(), session);
  EXPECT_EQ(difference(session, read_session(path())), "");
}

TEST_F(SessionFile, IsNeverOverwrittenByWriteSession) {
  write_session(path(), synthetic_session(2));
  const auto before = read_file(path());
  try {
    write_session(path(), synthetic_session(3));
    FAIL() << "an existing session was overwritten";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::storage);
    EXPECT_THAT(error.what(), testing::HasSubstr("exists"));
  }
  EXPECT_EQ(read_file(path()), before);
}

TEST_F(SessionFile, IsReplacedWholeByReplaceSession) {
  write_session(path(), synthetic_session(2));
  const Session other = synthetic_session(3, 8);
  replace_session(path(), other);
  EXPECT_EQ(difference(other, read_session(path())), "");
  EXPECT_EQ(files_in(folder_), 1U);
}

TEST_F(SessionFile, ALinkInItsPlaceIsNotFollowed) {
  fs::create_symlink(path("elsewhere.h5"), path());
  EXPECT_THROW(write_session(path(), synthetic_session(1)), Error);
  EXPECT_FALSE(fs::exists(path("elsewhere.h5")));
}

TEST_F(SessionFile, AFolderThatIsNotThereIsAStorageErrorWithAdvice) {
  try {
    write_session(folder_ / "no" / "one.h5", synthetic_session(1));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::storage);
    EXPECT_THAT(error.advice(), testing::HasSubstr("--output"));
  }
}

TEST_F(SessionFile, AFolderThatIsNotWritableIsAStorageErrorWithAdvice) {
  fs::permissions(folder_, fs::perms::owner_read | fs::perms::owner_exec | fs::perms::others_read |
                               fs::perms::others_exec);
  const auto write = [&] { write_session(path(), synthetic_session(1)); };
  EXPECT_EQ(tests::code_as_nobody(write, "--output"), static_cast<int>(ExitCode::storage));
  fs::permissions(folder_, fs::perms::owner_all);
}

/// The file size limit of a child stands for a full disk.
int write_to_full_disk(const fs::path& path) {
  const rlimit limit{300'000, 300'000};
  ::setrlimit(RLIMIT_FSIZE, &limit);
  std::signal(SIGXFSZ, SIG_IGN);
  try {
    write_session(path, synthetic_session(150));
  } catch (const Error& error) {
    return error.code() == ExitCode::storage ? 0 : 101;
  }
  return 102;
}

TEST_F(SessionFile, AFullDiskIsAStorageErrorAndLeavesNoFile) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(write_to_full_disk(path()));
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
  EXPECT_EQ(files_in(folder_), 0U);
}

TEST_F(SessionFile, DoesNotDependOnTheNumberOfThreadsOrOnTheTimeOfDay) {
  const Session session = synthetic_session(150);
  const auto bytes_with = [&](unsigned threads) {
    const SessionImage image = build_image(session, threads);
    return std::vector<std::byte>(image.bytes.begin(), image.bytes.end());
  };
  const auto one = bytes_with(1);
  EXPECT_TRUE(one == bytes_with(7));
  EXPECT_TRUE(one == bytes_with(2));
}

TEST_F(SessionFile, ChecksWhatItWroteAgainstWhatWasMeant) {
  SessionImage image = build_image(synthetic_session(150), 2);
  std::vector<std::byte> written(image.bytes.begin(), image.bytes.end());
  image.release();
  const auto check = [&] { check_written(tests::stored_bytes(written, "written"), image); };
  EXPECT_NO_THROW(check());
  const std::size_t step = written.size() / 97;
  for (std::size_t at = 0; at < written.size(); at += step) {
    written[at] ^= std::byte{1};
    EXPECT_THROW(check(), std::runtime_error) << at;
    written[at] ^= std::byte{1};
  }
  image.datasets.front().rows += 1;
  EXPECT_THROW(check(), std::runtime_error);
}

}  // namespace
}  // namespace thermorig::session
