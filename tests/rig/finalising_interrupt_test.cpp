// SPDX-License-Identifier: MIT
// Another Ctrl-C while the session is being made ends the program at once; the journal stays, and recovery
// makes the session. Each strikes at a call to the disk, not after a time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <functional>
#include <ostream>
#include <string_view>

#include "simulated_bus.h"
#include "thermorig/rig/finalise.h"
#include "thermorig/rig/port_recording.h"
#include "thermorig/simulated_ports/simulated_ports.h"

namespace thermorig::rig::test {
namespace {

using files::Answer;
using files::OpenFile;
using Path = std::filesystem::path;

/// The system's disk, and somebody who looks on when a name on it is about to change.
class WatchedDisk : public files::Disk {
 public:
  using Look = std::function<void(std::string_view call, const Path& path)>;
  explicit WatchedDisk(Look look) : look_(std::move(look)) {}

  Answer<OpenFile> create(const Path& path, unsigned mode) override {
    look_("create", path);
    return disk_.create(path, mode);
  }
  int rename(const Path& from, const Path& to) override {
    look_("rename", from);
    return disk_.rename(from, to);
  }
  int rename_to_new(const Path& from, const Path& to) override {
    look_("rename", from);
    return disk_.rename_to_new(from, to);
  }
  int remove(const Path& file) override {
    look_("remove", file);
    return disk_.remove(file);
  }
  Answer<OpenFile> open(const Path& path) override { return disk_.open(path); }
  Answer<OpenFile> open_to_lock(const Path& path) override { return disk_.open_to_lock(path); }
  Answer<std::size_t> append(OpenFile file, std::span<const std::span<const std::byte>> parts) override {
    return disk_.append(file, parts);
  }
  Answer<std::size_t> read(OpenFile file, std::uint64_t offset, std::span<std::byte> out) override {
    return disk_.read(file, offset, out);
  }
  Answer<std::uint64_t> size(OpenFile file) override { return disk_.size(file); }
  int sync(OpenFile file) override { return disk_.sync(file); }
  int reserve(OpenFile file, std::uint64_t bytes) override { return disk_.reserve(file, bytes); }
  int truncate(OpenFile file, std::uint64_t bytes) override { return disk_.truncate(file, bytes); }
  int close(OpenFile file) override { return disk_.close(file); }
  int lock(OpenFile file, Wait wait) override { return disk_.lock(file, wait); }
  Answer<files::FileKind> look(const Path& path) override { return disk_.look(path); }
  Answer<std::vector<files::FolderEntry>> list(const Path& folder) override { return disk_.list(folder); }
  int link(const Path& from, const Path& to) override { return disk_.link(from, to); }
  int make_folder(const Path& folder) override { return disk_.make_folder(folder); }
  int remove_folder(const Path& folder) override { return disk_.remove_folder(folder); }
  int sync_folder(const Path& folder) override { return disk_.sync_folder(folder); }
  Answer<std::uint64_t> free_bytes(const Path& path) override { return disk_.free_bytes(path); }

 private:
  files::Disk& disk_ = files::real_disk();
  Look look_;
};

struct Moment {
  const char* name;
  const char* call;
  const char* extension;  // of the file that it is about
  bool session_is_there;
};

void PrintTo(const Moment& moment, std::ostream* stream) {
  *stream << moment.name;
}

const Moment moments[] = {{"BeforeItsFileIsThere", "create", ".part", false},
                          {"BeforeItHasItsName", "rename", ".part", false},
                          {"BeforeTheJournalGoes", "remove", ".journal", true}};

std::vector<Path> files_with(const TemporaryFolder& folder, const std::string& extension) {
  std::vector<Path> found;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path()))
    if (entry.path().extension() == extension) found.push_back(entry.path());
  return found;
}

/// A recording on pseudo terminals: if `stops`, a first Ctrl-C within its first leg; then one more at the
/// moment.
void record_and_interrupt(const TemporaryFolder& folder, const Moment& moment, bool stops) {
  SimulatedPorts ports(simulation::default_rig(1, "kitchen"), FirmwareChoice::host_build);
  ports.start();
  PlanOverrides overrides;
  overrides.magnitudes_dps = {60.0};
  overrides.frames_per_leg = 8;
  overrides.opening_rest_s = overrides.closing_rest_s = 0.2;
  PortOptions options;
  options.recording =
      recording_options(folder, simulation::default_profile(), load_plan("quick", "kitchen", 1, overrides));
  options.recording.virtual_time = false;
  options.recording.sync.when = SyncWhen::period;
  options.recording.gate = GateMode::off;
  for (const Device device : all_devices) options.recording.profile.link(device).port = ports.paths()[device];
  bool is_stopped = !stops;
  options.progress = [&](const RecordingProgress& progress) {
    if (is_stopped || progress.sweep.phase != SweepPhase::leg) return;
    is_stopped = true;
    std::raise(SIGINT);
  };
  WatchedDisk disk([&](std::string_view call, const Path& path) {
    if (call == moment.call && path.extension() == moment.extension) std::raise(SIGINT);
  });
  options.recording.disk = &disk;
  record_ports(options);
}

/// How a process of its own ended that did it: as of waitpid().
int status_of_another_process(const TemporaryFolder& folder, const Moment& moment, bool stops) {
  const pid_t process = fork();
  if (process == 0) {
    alarm(120);
    try {
      record_and_interrupt(folder, moment, stops);
    } catch (const std::exception&) {
      _exit(1);
    }
    _exit(0);
  }
  int status = 0;
  waitpid(process, &status, 0);
  return status;
}

class FinalisingInterrupted : public ::testing::TestWithParam<Moment> {};
INSTANTIATE_TEST_SUITE_P(Moments, FinalisingInterrupted, ::testing::ValuesIn(moments),
                         [](const auto& moment) { return std::string(moment.param.name); });

TEST_P(FinalisingInterrupted, LeavesTheJournalOfWhichRecoveryMakesTheSession) {
  const TemporaryFolder folder;
  const int status = status_of_another_process(folder, GetParam(), true);
  ASSERT_TRUE(WIFSIGNALED(status)) << status;
  EXPECT_EQ(WTERMSIG(status), SIGINT);
  EXPECT_EQ(files_with(folder, ".journal").size(), 1U);
  EXPECT_EQ(files_with(folder, ".h5").size(), GetParam().session_is_there ? 1U : 0U);
  const auto results = recover(folder.path());
  ASSERT_EQ(results.size(), 1U);
  EXPECT_EQ(results[0].kind, GetParam().session_is_there ? RecoveryKind::already_there : RecoveryKind::made);
  EXPECT_EQ(results[0].bytes_ignored, 0U);
  EXPECT_EQ(files_with(folder, ".journal").size(), GetParam().session_is_there ? 1U : 0U);
  EXPECT_TRUE(files_with(folder, ".part").empty());
  const session::Session session = session::read_session(results[0].session);
  EXPECT_EQ(session.state, session::State::partial);
  EXPECT_FALSE(session.frames.empty());
}

TEST(FinalisingAtTheEnd, InterruptedByItsFirstCtrlCGoesOn) {
  const TemporaryFolder folder;
  const int status = status_of_another_process(folder, moments[1], false);
  ASSERT_TRUE(WIFEXITED(status)) << status;
  EXPECT_EQ(WEXITSTATUS(status), 0);
  EXPECT_TRUE(files_with(folder, ".journal").empty());
  ASSERT_EQ(files_with(folder, ".h5").size(), 1U);
  EXPECT_EQ(session::read_session(files_with(folder, ".h5")[0]).state, session::State::complete);
}

}  // namespace
}  // namespace thermorig::rig::test
