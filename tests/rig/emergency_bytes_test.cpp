// SPDX-License-Identifier: MIT
// Whatever ends the program in the middle of a leg, the last byte on the servo's port tells it to stop. A
// process of its own records in virtual time and dies so; a pipe stands for the port.
#include <gtest/gtest.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <new>
#include <stdexcept>
#include <vector>

#include "simulated_bus.h"
#include "thermorig/rig/recording/port_recording.h"
#include "thermorig/sensors/wire/servo_messages.h"
#include "virtual_ports.h"

namespace thermorig::rig::test {
namespace {

struct Death {
  const char* name;
  void (*strike)();
};

void PrintTo(const Death& death, std::ostream* stream) {
  *stream << death.name;
}

template <int signal>
void raise_signal() {
  std::raise(signal);
}

__attribute__((noinline, no_sanitize("undefined"))) void dereference_null() {
  int* volatile nowhere = nullptr;
  *nowhere = 1;
}

__attribute__((noinline)) int overflow(int depth) {  // NOLINT: that is what it is for
  volatile char frame[4096];
  if (depth < 0) return 0;  // never: no stack is so large
  frame[0] = static_cast<char>(depth);
  return overflow(depth + 1) + frame[0];
}

#ifdef THERMORIG_MEMORY_MAY_BE_GONE
/// No allocation of this process succeeds any more.
void use_up_memory() {
  const rlimit nothing{0, 0};
  setrlimit(RLIMIT_AS, &nothing);
  for (std::size_t size = 1U << 20U;;) {
    if (::operator new(size, std::nothrow) != nullptr) continue;
    if (size == 1) throw std::bad_alloc();
    size /= 2;
  }
}
#endif

const Death deaths[] = {
    {"Quit", raise_signal<SIGQUIT>},
    {"Aborted", std::abort},
    {"Exited", [] { std::exit(3); }},
    {"ExceptionThrown", [] { throw std::runtime_error("out of nowhere"); }},
    {"TerminateCalled", std::terminate},
    {"NullDereferenced", dereference_null},
    {"StackOverflown", [] { overflow(0); }},
#ifdef THERMORIG_MEMORY_MAY_BE_GONE
    {"MemoryGone", use_up_memory},
#endif
};

/// A shell's background job ignores it. Now, before any test: the program's own handlers are put there once
/// in a process, by the first test that opens a servo's port, and must stay.
[[maybe_unused]] const auto quit_before = std::signal(SIGQUIT, SIG_DFL);

/// Dies in the first leg, or exits with 1 if an exception came out of it; with 0 if it lived.
[[noreturn]] void record_and_die(const TemporaryFolder& folder, const Death& death, int servo_port) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);  // if it hangs it goes with its test
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  VirtualPorts ports(simulation::default_rig(1, "kitchen"));
  ports.say_last_words_to(servo_port);
  PortOptions options;
  options.recording = recording_options(folder, simulation::default_profile(), short_plan());
  for (const Device device : all_devices) options.recording.profile.link(device).port = ports.paths()[device];
  options.progress_period = std::chrono::milliseconds(50);
  options.progress = [&death](const RecordingProgress& progress) {
    if (progress.sweep.phase == SweepPhase::leg && progress.sweep.frames > 2) death.strike();
  };
  try {
    record_ports(options, ports);
  } catch (const std::exception&) {
    _exit(1);
  }
  _exit(0);
}

std::vector<std::uint8_t> read_to_the_end(int descriptor) {
  std::vector<std::uint8_t> all;
  std::array<std::uint8_t, 64> some{};
  for (ssize_t size = 0; (size = read(descriptor, some.data(), some.size())) > 0;)
    all.insert(all.end(), some.begin(), some.begin() + size);
  return all;
}

class EmergencyBytes : public ::testing::TestWithParam<Death> {};
INSTANTIATE_TEST_SUITE_P(Deaths, EmergencyBytes, ::testing::ValuesIn(deaths),
                         [](const auto& death) { return std::string(death.param.name); });

TEST_P(EmergencyBytes, TellTheServoToStop) {
  const TemporaryFolder folder;
  std::array<int, 2> port{};
  ASSERT_EQ(pipe(port.data()), 0);
  const pid_t process = fork();
  if (process == 0) record_and_die(folder, GetParam(), port[1]);
  close(port[1]);
  const std::vector<std::uint8_t> words = read_to_the_end(port[0]);
  close(port[0]);
  int status = 0;
  waitpid(process, &status, 0);
  EXPECT_FALSE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  const auto stop = wire::stop_bytes();
  ASSERT_GE(words.size(), stop.size());
  EXPECT_TRUE(std::equal(stop.rbegin(), stop.rend(), words.rbegin()));
}

}  // namespace
}  // namespace thermorig::rig::test
