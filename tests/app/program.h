// SPDX-License-Identifier: MIT
#pragma once

#include <gtest/gtest.h>
#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "support/checked.h"

namespace thermorig::tests {

/// What a run of the program left behind.
struct Outcome {
  int code = -1;
  std::string out;
  std::string err;

  /// Standard output, a JSON value a line. A line that is none fails the test.
  Checked<nlohmann::json> lines() const;
};

/// Runs the built program in a folder of its own, which is removed afterwards.
class ProgramTest : public ::testing::Test {
 protected:
  ProgramTest();
  ~ProgramTest() override;

  /// Runs `thermorig ARGUMENTS`; the arguments are words of a shell.
  Outcome run(const std::string& arguments) const;

  /// The same, which may write no file beyond so many KiB.
  Outcome run_with_files_up_to(int kib, const std::string& arguments) const;

  /// The same on a terminal, with NAME=VALUE words before it; what the terminal got is in `out`.
  Outcome run_on_terminal(const std::string& settings, const std::string& arguments) const;

  /// Starts it in the background; its output goes to background_out.txt and _err.txt.
  pid_t start(const std::vector<std::string>& arguments) const;
  /// Waits for it: exit code, or 128 + signal.
  Outcome wait(pid_t process) const;

  /// `record --fast WORDS` for each of these words, one after another. The program makes the same of the same
  /// words, so in a folder without recordings this is a copy of what it recorded once for all tests.
  void record_once(const std::vector<std::string>& recordings) const;

  /// A short recording in virtual time; returns the session's path.
  std::filesystem::path record_briefly() const;

  std::filesystem::path write(const std::string& name, std::span<const std::uint8_t> bytes) const;
  const std::filesystem::path& folder() const { return folder_; }
  Checked<std::filesystem::path> files(const std::string& extension) const;

 private:
  std::filesystem::path folder_;
};

/// The plan of record_briefly(): four legs of a few frames.
inline const std::string brief_plan = "--plan quick --speeds 40,80 --frames-per-leg 12";

}  // namespace thermorig::tests
