// SPDX-License-Identifier: MIT
#include "drill.h"

#include <signal.h>

#include <algorithm>
#include <fstream>
#include <thread>

#include "thermorig/journal/journal.h"

namespace thermorig::tests {

namespace {

constexpr auto patience = std::chrono::seconds(60);  // of a wait that ought to be short
constexpr std::int64_t rest_us = 300'000;
constexpr std::int64_t crystal_us = 1'000;
constexpr std::int64_t moved_before_us = 1'000'000;
constexpr double rest_dps = 1.0;
constexpr double moving_dps = 20.0;
constexpr std::size_t unread_bytes = 8192;  // of a port whose reader is gone: what a pty holds, and more

bool has_first_leg(const std::filesystem::path& journal) {
  if (!journal::is_journal(journal)) return false;
  const auto events = journal::read_journal(journal).recording.events;
  return std::any_of(events.begin(), events.end(),
                     [](const RecordingEvent& event) { return event.kind == EventKind::leg_start; });
}

}  // namespace

std::string name_of(Mishap mishap) {
  constexpr const char* names[] = {"CameraUnplugged", "GyroUnplugged", "ServoUnplugged", "HostFrozen",
                                   "ProgramKilled"};
  return names[static_cast<std::size_t>(mishap)];
}

Drill::Drill() {
  rig_.write_profile(folder() / "rig.toml");
}

void Drill::wait_until(const std::function<bool()>& happened) const {
  const auto limit = std::chrono::steady_clock::now() + patience;
  while (!happened()) {
    ASSERT_LT(std::chrono::steady_clock::now(), limit) << "what the drill waits for did not happen";
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

void Drill::strike(Mishap mishap, pid_t process) {
  switch (mishap) {
    case Mishap::camera_unplugged:
      return unplug(Device::camera);
    case Mishap::gyro_unplugged:
      return unplug(Device::gyro);
    case Mishap::servo_unplugged:
      return unplug(Device::servo);
    case Mishap::host_frozen:
      kill(process, SIGSTOP);
      rig_.let_pass(1'000'000);
      kill(process, SIGCONT);
      return;
    case Mishap::program_killed:
      kill(process, SIGKILL);
  }
}

/// The plug is pulled by the thread that serves the port: what counts is when it is gone.
void Drill::unplug(Device device) {
  const std::filesystem::path port = rig_.ports().paths()[device];
  rig_.ports().unplug(device);
  while (std::filesystem::exists(port)) std::this_thread::yield();
  unplugged_us_ = rig_.line().now_us;
}

Outcome Drill::suffer(const std::vector<std::string>& command, Mishap mishap, int frames_per_leg) {
  std::ofstream(folder() / "plan.toml")
      << "magnitudes_dps = [90.0]\norder = \"given\"\nvalid_per_leg = 0\nframes_per_leg = " << frames_per_leg
      << "\nopening_rest_s = 0.3\nclosing_rest_s = 0.3\n";
  std::vector<std::string> words = command;
  for (const char* word : {"--environment", "garden", "--rig", "./rig.toml", "--plan", "plan.toml"})
    words.emplace_back(word);
  const pid_t process = start(words);
  wait_until([this] {
    const auto journals = files(".journal");
    return !journals.empty() && has_first_leg(journals.front());
  });
  rig_.let_pass(400'000);
  strike(mishap, process);
  const Outcome outcome = wait(process);
  rig_.let_pass(2 * rest_us);
  rig_.ports().stop();
  return outcome;
}

void Drill::expect_rest(Mishap mishap) const {
  const auto& received = rig_.line().received;
  ASSERT_FALSE(received.empty());
  auto last = std::prev(received.end());
  std::int64_t until_us = rig_.line().now_us;
  if (mishap == Mishap::host_frozen) {
    last = std::adjacent_find(received.begin(), received.end(), [](const auto& one, const auto& next) {
      return next.time_us - one.time_us > 700'000;
    });
    ASSERT_NE(last, received.end());
    until_us = std::next(last)->time_us;
  }
  const bool was_cut_off = mishap != Mishap::camera_unplugged && mishap != Mishap::gyro_unplugged;
  if (was_cut_off) {
    EXPECT_GT(rig_.fastest_dps(last->time_us - moved_before_us, last->time_us), moving_dps);
  }
  EXPECT_LT(rig_.fastest_dps(last->time_us + rest_us + crystal_us, until_us), rest_dps);
}

void Drill::expect_rest_at_once() const {
  ASSERT_GT(unplugged_us_, 0);
  EXPECT_GT(rig_.fastest_dps(unplugged_us_ - moved_before_us, unplugged_us_), moving_dps);
  EXPECT_LT(rig_.fastest_dps(unplugged_us_ + rest_us + crystal_us, rig_.line().now_us), rest_dps);
}

void Drill::expect_complete(const session::Session& session) const {
  for (const Device device : all_devices) {
    const std::vector<std::uint8_t>& delivered = rig_.ports().delivered(device);
    const std::vector<std::uint8_t>& recorded = session.raw.received[device].bytes;
    ASSERT_FALSE(recorded.empty()) << name_of(device);
    const auto found = std::search(delivered.begin(), delivered.end(), recorded.begin(), recorded.end());
    ASSERT_NE(found, delivered.end()) << name_of(device);
    const auto behind = delivered.end() - found - static_cast<std::ptrdiff_t>(recorded.size());
    EXPECT_LE(static_cast<std::size_t>(behind), unread_bytes) << name_of(device);
  }
}

session::Session Drill::only_session() const {
  const auto sessions = files(".h5");
  EXPECT_EQ(sessions.size(), 1U);
  return sessions.empty() ? session::Session() : session::read_session(sessions[0]);
}

}  // namespace thermorig::tests
