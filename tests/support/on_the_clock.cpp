// SPDX-License-Identifier: MIT
// on_the_clock PROGRAM ARGUMENTS...: runs a test that needs the wall clock. Assertions that fail (exit code
// 1) while this computer stood still for longer than the servo waits for an answer say nothing: that run is
// void (void_runs.h). Crashes, what a sanitizer finds, and whatever fails while the computer ran count at
// once. Drills look at the computer themselves: of them the servo's rest and limits are judged in void runs
// too.
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "stall_probe.h"
#include "void_runs.h"

extern char** environ;

namespace {

int run(char** words) {
  pid_t process = 0;
  int status = 0;
  if (posix_spawn(&process, words[0], nullptr, nullptr, words, environ) != 0) return 127;
  waitpid(process, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/// What a test calls itself: the filter of its program, or its program's first argument.
std::string name_of(char** words) {
  const std::string filter = "--gtest_filter=";
  for (char** word = words; *word != nullptr; ++word)
    if (std::string(*word).starts_with(filter)) return std::string(*word).substr(filter.size());
  return words[1] != nullptr ? words[1] : words[0];
}

}  // namespace

int main(int count, char** words) {
  using namespace thermorig::tests;
  if (count < 2) return 2;
  ++words;
  const std::string name = name_of(words);
  const bool judges_itself = name.find("Drill") != std::string::npos;
  for (const char* sanitizer : {"ASAN_OPTIONS", "UBSAN_OPTIONS"})  // whose own exit code is 1 as well
    setenv(sanitizer, "exitcode=66", 0);
  const auto build = std::filesystem::read_symlink("/proc/self/exe").parent_path().parent_path();
  setenv("THERMORIG_LEDGER", (build / "Testing" / "void_runs.txt").c_str(), 0);  // drills note theirs as well
  for (VoidRuns runs(name);;) {
    const StallProbe probe;
    const int code = run(words);
    if (code != 1 || judges_itself || probe.worst_s() < stall_s || !runs.may_run_again(probe.worst_s()))
      return code;
  }
}
