// SPDX-License-Identifier: MIT
// Another Ctrl-C while the session is being made ends the program at once; the journal stays, and recovery
// makes the session. Each strikes at a call to the disk, not after a time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <ostream>
#include <string_view>

#include "simulated_bus.h"
#include "thermorig/rig/recording/finalise.h"
#include "thermorig/rig/recording/port_recording.h"
#include "thermorig/simulation/simulated_ports/simulated_ports.h"
#include "virtual_ports.h"
#include "watched_disk.h"

namespace thermorig::rig::test {
namespace {

using Path = std::filesystem::path;

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

/// A short recording: if `stops`, a first Ctrl-C within its first leg; then one more at the moment.
struct InterruptedRecording {
  InterruptedRecording(const TemporaryFolder& folder, const Moment& moment, bool stops)
      : disk([&moment](std::string_view call, const Path& path) {
          if (call == moment.call && path.extension() == moment.extension) std::raise(SIGINT);
        }) {
    PlanOverrides overrides;
    overrides.magnitudes_dps = {60.0};
    overrides.frames_per_leg = 8;
    overrides.opening_rest_s = overrides.closing_rest_s = 0.2;
    options.recording =
        recording_options(folder, simulation::default_profile(), load_plan("quick", "kitchen", 1, overrides));
    options.recording.disk = &disk;
    options.progress = [is_stopped = !stops](const RecordingProgress& progress) mutable {
      if (is_stopped || progress.sweep.phase != SweepPhase::leg) return;
      is_stopped = true;
      std::raise(SIGINT);
    };
  }
  InterruptedRecording(const InterruptedRecording&) = delete;

  void go(const PerDevice<std::string>& ports, PortLoop& loop) {
    for (const Device device : all_devices) options.recording.profile.link(device).port = ports[device];
    record_ports(options, loop);
  }

  WatchedDisk disk;
  PortOptions options;
};

void in_virtual_time(InterruptedRecording& recording) {
  VirtualPorts ports(simulation::default_rig(1, "kitchen"));
  recording.go(ports.paths(), ports);
}

void on_pseudo_terminals(InterruptedRecording& recording) {
  SimulatedPorts ports(simulation::default_rig(1, "kitchen"), FirmwareChoice::host_build);
  ports.start();
  recording.options.recording.virtual_time = false;
  recording.options.recording.sync_period = std::chrono::milliseconds(125);
  SystemPortLoop loop;
  recording.go(ports.paths(), loop);
}

/// How a process of its own ended that did it: as of waitpid().
int status_of_another_process(InterruptedRecording&& recording, void (*record)(InterruptedRecording&)) {
  const pid_t process = fork();
  if (process == 0) {
    alarm(120);
    try {
      record(recording);
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

void expect_recoverable(const TemporaryFolder& folder, const Moment& moment, int status) {
  ASSERT_TRUE(WIFSIGNALED(status)) << status;
  EXPECT_EQ(WTERMSIG(status), SIGINT);
  EXPECT_EQ(files_with(folder, ".journal").size(), 1U);
  EXPECT_EQ(files_with(folder, ".h5").size(), moment.session_is_there ? 1U : 0U);
  const auto results = recover(folder.path());
  ASSERT_FALSE(results.empty());  // behind it what was half written
  EXPECT_EQ(results[0].kind, moment.session_is_there ? RecoveryKind::already_there : RecoveryKind::made);
  EXPECT_EQ(results[0].bytes_ignored, 0U);
  EXPECT_EQ(files_with(folder, ".journal").size(), moment.session_is_there ? 1U : 0U);
  EXPECT_TRUE(files_with(folder, ".part").empty());
  const session::Session session = session::read_session(results[0].session);
  EXPECT_EQ(session.state, session::State::partial);
  EXPECT_FALSE(session.frames.empty());
}

TEST_P(FinalisingInterrupted, LeavesTheJournalOfWhichRecoveryMakesTheSession) {
  const TemporaryFolder folder;
  const int status = status_of_another_process({folder, GetParam(), true}, in_virtual_time);
  expect_recoverable(folder, GetParam(), status);
}

/// There the first Ctrl-C was the loop's.
TEST(FinalisingOnPseudoTerminals, InterruptedLeavesTheJournalOfWhichRecoveryMakesTheSession) {
  const TemporaryFolder folder;
  const int status = status_of_another_process({folder, moments[1], true}, on_pseudo_terminals);
  expect_recoverable(folder, moments[1], status);
}

TEST(FinalisingAtTheEnd, InterruptedByItsFirstCtrlCGoesOn) {
  const TemporaryFolder folder;
  const int status = status_of_another_process({folder, moments[1], false}, in_virtual_time);
  ASSERT_TRUE(WIFEXITED(status)) << status;
  EXPECT_EQ(WEXITSTATUS(status), 0);
  EXPECT_TRUE(files_with(folder, ".journal").empty());
  ASSERT_EQ(files_with(folder, ".h5").size(), 1U);
  EXPECT_EQ(session::read_session(files_with(folder, ".h5")[0]).state, session::State::complete);
}

}  // namespace
}  // namespace thermorig::rig::test
