// SPDX-License-Identifier: MIT
#include "killed_recording.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "rig/simulated_bus.h"

namespace thermorig::tests {

namespace {

constexpr double life_s = 6.0;  // of virtual time

void record_and_die(const std::filesystem::path& folder) {
  rig::test::SimulatedBus bus(simulation::default_rig(3, "garden"));
  const auto options =
      rig::test::recording_options(folder, simulation::default_profile(), rig::test::short_plan());
  rig::test::run_to_journal(bus, options, {.each_step = [](rig::Recording&, HostTime now) {
                              if (to_s(now - HostTime{}) > life_s) std::raise(SIGKILL);
                            }});
}

}  // namespace

void record_and_be_killed(const std::filesystem::path& folder) {
  const pid_t process = fork();
  if (process == 0) {
    record_and_die(folder);
    _exit(0);
  }
  int status = 0;
  waitpid(process, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL) << status;
}

}  // namespace thermorig::tests
