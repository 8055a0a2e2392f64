// SPDX-License-Identifier: MIT
#include "reading_progress.h"

#include <fmt/format.h>

#include <utility>

#include "output.h"
#include "terminal_width.h"

namespace thermorig::app {

std::string reading_text(const std::string& work, std::size_t done, std::size_t all, double elapsed_s) {
  std::string text = fmt::format("{}: {} of {}", work, done, all);
  if (done == 0 || done >= all || elapsed_s < 1.0) return text;
  const double left_s = elapsed_s * static_cast<double>(all - done) / static_cast<double>(done);
  return text + ", " + duration_text(left_s) + " left";
}

ReadingProgress::ReadingProgress(bool json, Elsewhere elsewhere, std::string work)
    : work_(std::move(work)),
      on_a_terminal_(!json && escapes_allowed(stdout)),
      in_lines_(!json && !on_a_terminal_ && elsewhere == Elsewhere::lines) {}

ReadingProgress::~ReadingProgress() {
  if (on_a_terminal_) write_to(stdout, drawn_over(""));
}

void ReadingProgress::operator()(std::size_t done, std::size_t all) {
  constexpr std::chrono::seconds between_lines{10};
  if (!on_a_terminal_ && !in_lines_) return;
  const auto now = std::chrono::steady_clock::now();
  const std::string text =
      reading_text(work_, done, all, std::chrono::duration<double>(now - begin_).count());
  if (on_a_terminal_) {
    write_to(stdout, drawn_over(text));
  } else if (now - told_ >= between_lines) {
    print("{}\n", text);
    told_ = now;
  } else {
    return;
  }
  flush_output();
}

}  // namespace thermorig::app
