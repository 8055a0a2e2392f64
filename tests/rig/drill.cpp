// SPDX-License-Identifier: MIT
#include "drill.h"

#include <fmt/format.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>
#include <thread>
#include <utility>

#include "acceptance/growing_journal.h"
#include "servo_limits.h"
#include "support/stall_probe.h"
#include "support/void_runs.h"

namespace thermorig::tests {

namespace {

constexpr auto longest_wait = std::chrono::seconds(60);  // of a wait that ought to be short
constexpr std::int64_t rest_us = 300'000;
constexpr std::int64_t crystal_us = 1'000;
constexpr std::int64_t moved_before_us = 1'000'000;
constexpr double rest_dps = 1.0;
constexpr double moving_dps = 20.0;
constexpr std::size_t unread_bytes = 8192;  // of a port whose reader is gone: what a pty holds, and more

bool has_ended(pid_t process) {
  siginfo_t info{};
  return waitid(P_PID, static_cast<id_t>(process), &info, WEXITED | WNOHANG | WNOWAIT) == 0 &&
         info.si_pid == process;
}

}  // namespace

std::string name_of(Mishap mishap) {
  constexpr const char* names[] = {"CameraUnplugged", "GyroUnplugged", "ServoUnplugged",
                                   "HostFrozen",      "ProgramKilled", "Interrupted",
                                   "HungUp",          "Quit",          "DiskFull"};
  return names[static_cast<std::size_t>(mishap)];
}

Drill::Drill() {
  make_rig();
}

void Drill::make_rig() {
  rig_.emplace(3, "garden");
  rig_->write_profile(folder() / "rig.toml");
  unplugged_us_ = struck_us_ = 0;
}

void Drill::wait_until(const std::function<bool()>& happened) const {
  const auto limit = std::chrono::steady_clock::now() + longest_wait;
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
      rig_->let_pass(1'000'000);
      kill(process, SIGCONT);
      return;
    case Mishap::program_killed:
      return void(kill(process, SIGKILL));
    case Mishap::interrupted:
      return void(kill(process, SIGINT));
    case Mishap::hung_up:
      return void(kill(process, SIGHUP));
    case Mishap::quit:
      return void(kill(process, SIGQUIT));
    case Mishap::disk_full: {
      const rlimit nothing{0, RLIM_INFINITY};
      return void(prlimit(process, RLIMIT_FSIZE, &nothing, nullptr));
    }
  }
}

/// The plug is pulled by the thread that serves the port: what counts is when it is gone.
void Drill::unplug(Device device) {
  const std::filesystem::path port = rig_->ports().paths()[device];
  rig_->ports().unplug(device);
  while (std::filesystem::exists(port)) std::this_thread::yield();
  unplugged_us_ = rig_->line().now_us;
}

Outcome Drill::suffer(const std::vector<std::string>& command, Mishap mishap, int frames_per_leg) {
  for (VoidRuns runs(fmt::format("the drill {} of {}", name_of(mishap), command.front()));;) {
    const StallProbe probe;
    const Outcome outcome = suffer_once(command, mishap, frames_per_leg);
    const double stood_still_s = std::max(probe.worst_s(), rig_->ports().tally().worst_lag_s);
    if (stood_still_s < stall_s || !runs.may_run_again(stood_still_s)) {
      if (struck_us_ == 0)
        ADD_FAILURE() << "it ended with " << outcome.code << " before anything moved\n"
                      << outcome.out << outcome.err;
      return outcome;
    }
    expect_rest_in_the_end();
    if (!rig_->line().pulses.empty()) expect_within_limits();
    if (HasFailure()) return outcome;
    std::filesystem::remove_all(folder() / "recordings");
    make_rig();
  }
}

Outcome Drill::suffer_once(const std::vector<std::string>& command, Mishap mishap, int frames_per_leg) {
  std::ofstream(folder() / "plan.toml")
      << "magnitudes_dps = [90.0]\norder = \"given\"\nvalid_per_leg = 0\nframes_per_leg = " << frames_per_leg
      << "\nopening_rest_s = 0.3\nclosing_rest_s = 0.3\n";
  command_ = command.front();
  mishap_ = mishap;
  std::vector<std::string> words = command;
  for (const char* word : {"--environment", "garden", "--rig", "./rig.toml", "--plan", "plan.toml"})
    words.emplace_back(word);
  const pid_t process = start(words);
  wait_until([this, process] {
    const auto journals = files(".journal");
    return has_ended(process) || (!journals.empty() && has_first_leg(journals.front()));
  });
  if (!has_ended(process)) {
    rig_->let_pass(400'000);
    // A busy computer may have had the servo's watchdog trip meanwhile: then nothing moves until it is armed
    // again.
    wait_until([this] { return rig_->line().turned_us > rig_->line().now_us - 50'000; });
    struck_us_ = rig_->line().now_us;
    strike(mishap, process);
  }
  const Outcome outcome = wait(process);
  rig_->let_pass(2 * rest_us);
  rig_->ports().stop();
  return outcome;
}

void Drill::expect_rest_from(std::int64_t from_us, std::int64_t until_us) {
  EXPECT_LT(rig_->fastest_dps(from_us + rest_us + crystal_us, until_us), rest_dps);
}

void Drill::expect_rest_in_the_end() {
  const auto& received = rig_->line().received;
  if (!received.empty()) expect_rest_from(received.back().time_us, rig_->line().now_us);
}

void Drill::expect_rest(Mishap mishap) {
  const auto& received = rig_->line().received;
  ASSERT_FALSE(received.empty());
  auto last = std::prev(received.end());
  std::int64_t until_us = rig_->line().now_us;
  if (mishap == Mishap::host_frozen) {
    last = std::adjacent_find(received.begin(), received.end(), [](const auto& one, const auto& next) {
      return next.time_us - one.time_us > 700'000;
    });
    ASSERT_NE(last, received.end());
    until_us = std::next(last)->time_us;
  }
  const bool was_cut_off = mishap != Mishap::camera_unplugged && mishap != Mishap::gyro_unplugged;
  if (was_cut_off) {
    print_rest(last->time_us, until_us);
    EXPECT_GT(rig_->fastest_dps(last->time_us - moved_before_us, last->time_us), moving_dps);
  }
  expect_rest_from(last->time_us, until_us);
}

void Drill::expect_rest_at_once() {
  ASSERT_GT(unplugged_us_, 0);
  if (mishap_ != Mishap::servo_unplugged)
    print_rest(unplugged_us_, rig_->line().now_us);  // else expect_rest()
  EXPECT_GT(rig_->fastest_dps(unplugged_us_ - moved_before_us, unplugged_us_), moving_dps);
  expect_rest_from(unplugged_us_, rig_->line().now_us);
}

void Drill::print_rest(std::int64_t from_us, std::int64_t until_us) const {
  const std::int64_t took_us = std::max<std::int64_t>(0, rig_->last_motion_us(rest_dps, until_us) - from_us);
  std::cout << fmt::format("drill: {} {} {:.0f} ms\n", command_, name_of(mishap_),
                           1e-3 * static_cast<double>(took_us));
}

void Drill::expect_rest_after_the_end() {
  ASSERT_GT(struck_us_, 0);
  print_rest(struck_us_, rig_->line().now_us);
  EXPECT_GT(rig_->fastest_dps(struck_us_ - moved_before_us, struck_us_), moving_dps);
  expect_rest_from(struck_us_, rig_->line().now_us);
}

void Drill::expect_within_limits() {
  rig::test::expect_within_limits(rig_->line().pulses, rig_->profile().servo);
}

void Drill::expect_complete(const session::Session& session) const {
  for (const Device device : all_devices) {
    const std::vector<std::uint8_t>& delivered = rig_->ports().delivered(device);
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
  return session::read_session(sessions[0]);
}

}  // namespace thermorig::tests
