// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace thermorig::app {

/// "reading sessions: 12 of 40, 25 s left" after `elapsed_s` seconds in which `done` of `all` were read. The
/// time that is left takes the others to be as long as those that were read; within the first second, and
/// before the first is read, it is not told. `work`: "reading sessions".
std::string reading_text(const std::string& work, std::size_t done, std::size_t all, double elapsed_s);

/// Tells how many sessions were read, or worked on, so far and how long the rest will take: on a terminal in
/// one line, which is gone when this is; elsewhere, where such lines are wanted among what is printed, in one
/// every ten seconds; with --json not at all.
class ReadingProgress {
 public:
  enum class Elsewhere : bool { nothing, lines };
  explicit ReadingProgress(bool json, Elsewhere elsewhere = Elsewhere::nothing,
                           std::string work = "reading sessions");
  ~ReadingProgress();
  ReadingProgress(const ReadingProgress&) = delete;
  ReadingProgress& operator=(const ReadingProgress&) = delete;

  /// From one thread at a time.
  void operator()(std::size_t done, std::size_t all);

 private:
  std::string work_;
  bool on_a_terminal_;
  bool in_lines_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point told_ = begin_;
};

}  // namespace thermorig::app
