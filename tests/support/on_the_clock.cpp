// SPDX-License-Identifier: MIT
// on_the_clock PROGRAM ARGUMENTS...: runs a test that needs the wall clock. Assertions that fail (exit code
// 1) while this computer kept a byte waiting for longer than the servo waits for an answer say little: the
// test runs again once the computer is quiet, three times at most, and the last run counts. Crashes and what
// a sanitizer finds count at once, and get no second try. Drills look at the computer themselves: of them the
// servo's rest and limits are judged in every run. Without a program it waits until the computer is quiet.
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "stall_probe.h"

extern char** environ;

namespace {

bool is_drill(char** words) {
  for (; *words != nullptr; ++words)
    if (std::string_view(*words).find("Drill") != std::string_view::npos) return true;
  return false;
}

int run(char** words) {
  pid_t process = 0;
  int status = 0;
  if (posix_spawn(&process, words[0], nullptr, nullptr, words, environ) != 0) return 127;
  waitpid(process, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

int main(int count, char** words) {
  using namespace thermorig::tests;
  if (count < 2) {
    wait_for_a_quiet_machine(stall_s);
    return 0;
  }
  ++words;
  const int runs = is_drill(words) ? 1 : runs_max;
  for (const char* sanitizer : {"ASAN_OPTIONS", "UBSAN_OPTIONS"})  // whose own exit code is 1 as well
    setenv(sanitizer, "exitcode=66", 0);
  for (int i = 1;; ++i) {
    if (i > 1) wait_for_a_quiet_machine(stall_s);
    const StallProbe probe;
    const int code = run(words);
    if (code > 1) std::printf("exit code %d: %s\n", code, no_second_try);
    if (code != 1 || probe.worst_s() < stall_s || i == runs) return code;
    std::printf("run %d is void: this computer kept a byte waiting for %.0f ms\n", i, 1e3 * probe.worst_s());
    std::fflush(stdout);
  }
}
