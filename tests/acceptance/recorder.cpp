// SPDX-License-Identifier: MIT
#include "recorder.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <thread>

#include "growing_journal.h"

namespace thermorig::tests {

namespace {

constexpr auto patience = std::chrono::seconds(60);  // of a wait that ought to be short
constexpr std::int64_t rest_us = 300'000;
constexpr std::int64_t crystal_us = 1'000;
constexpr double rest_dps = 1.0;

constexpr const char* preload = THERMORIG_READ_LEDGER_LIBRARY;  // empty if there is none

std::size_t port_number(const std::string& path) {
  return std::stoul(path.substr(path.rfind('/') + 1));
}

}  // namespace

RecorderOnPorts::RecorderOnPorts() {
  rig_.write_profile(folder() / "rig.toml");
  open_ledger();
}

RecorderOnPorts::~RecorderOnPorts() {
  if (ledger_ != nullptr) munmap(ledger_, sizeof *ledger_);
}

void RecorderOnPorts::open_ledger() {
  if (*preload == '\0') return;
  const int file = open((folder() / "ledger").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  ASSERT_EQ(ftruncate(file, sizeof *ledger_), 0);
  void* memory = mmap(nullptr, sizeof *ledger_, PROT_READ, MAP_SHARED, file, 0);
  close(file);
  ASSERT_NE(memory, MAP_FAILED);
  ledger_ = static_cast<read_ledger*>(memory);
}

pid_t RecorderOnPorts::start_recording(int frames_per_leg) {
  std::ofstream(folder() / "plan.toml")
      << "magnitudes_dps = [90.0]\norder = \"given\"\nframes_per_leg = " << frames_per_leg
      << "\nopening_rest_s = 0.3\nclosing_rest_s = 0.3\n";
  if (ledger_ != nullptr) {
    setenv(READ_LEDGER_VARIABLE, (folder() / "ledger").c_str(), 1);
    setenv("LD_PRELOAD", preload, 1);
  }
  process_ = start({"record", "--environment", "garden", "--rig", "./rig.toml", "--plan", "plan.toml"});
  unsetenv("LD_PRELOAD");
  return process_;
}

bool RecorderOnPorts::has_ended() const {
  siginfo_t ended{};  // the program stays a child to be waited for
  return waitid(P_PID, static_cast<id_t>(process_), &ended, WEXITED | WNOHANG | WNOWAIT) == 0 &&
         ended.si_pid == process_;
}

void RecorderOnPorts::wait_until(const std::function<bool()>& happened) const {
  const auto limit = std::chrono::steady_clock::now() + patience;
  for (;;) {
    const bool last_look = has_ended() || std::chrono::steady_clock::now() > limit;
    if (happened()) return;
    if (last_look) {
      ADD_FAILURE() << "what the test waits for did not happen";
      return;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

void RecorderOnPorts::wait_for_first_leg() const {
  wait_until([this] {
    const auto journals = files(".journal");
    return !journals.empty() && has_first_leg(journals[0]);
  });
}

std::filesystem::path RecorderOnPorts::only_journal() const {
  const auto journals = files(".journal");
  EXPECT_EQ(journals.size(), 1U);
  return journals[0];
}

session::Session RecorderOnPorts::only_session() const {
  const auto sessions = files(".h5");
  EXPECT_EQ(sessions.size(), 1U);
  return session::read_session(sessions[0]);
}

std::optional<read_ledger_port> RecorderOnPorts::read_from(Device device) const {
  if (ledger_ == nullptr) return std::nullopt;
  const std::size_t number = port_number(rig_.ports().paths()[device]);
  return number < READ_LEDGER_PORTS ? std::optional(ledger_->ports[number]) : std::nullopt;
}

RecorderOnPorts::Extent RecorderOnPorts::extent_of(Device device, const session::Session& session) const {
  const std::vector<std::uint8_t>& delivered = rig_.ports().delivered(device);
  const std::vector<std::uint8_t>& recorded = session.raw.received[device].bytes;
  EXPECT_FALSE(recorded.empty()) << name_of(device);
  const auto found = std::search(delivered.begin(), delivered.end(), recorded.begin(), recorded.end());
  if (found == delivered.end()) {
    ADD_FAILURE() << name_of(device) << ": the recorded bytes are no piece of those that were delivered";
    return {};
  }
  const auto head = static_cast<std::size_t>(found - delivered.begin());
  return {head, recorded.size(), delivered.size() - head - recorded.size()};
}

void RecorderOnPorts::expect_rest_after_last_byte() const {
  const std::int64_t rest_begin_us = rig_.last_byte_us() + rest_us + crystal_us;
  ASSERT_LT(rest_begin_us, rig_.line().now_us);
  EXPECT_LT(rig_.fastest_dps(rest_begin_us, rig_.line().now_us), rest_dps);
}

std::vector<std::string> messages_of(const RawRecording& raw, EventKind kind) {
  std::vector<std::string> messages;
  for (const RecordingEvent& event : raw.events)
    if (event.kind == kind) messages.push_back(event.message);
  return messages;
}

}  // namespace thermorig::tests
