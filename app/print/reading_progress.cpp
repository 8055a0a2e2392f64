// SPDX-License-Identifier: MIT
#include "reading_progress.h"

#include "output.h"

namespace thermorig::app {

ReadingProgress::ReadingProgress(bool json) : is_told_(!json && escapes_allowed(stdout)) {}

ReadingProgress::~ReadingProgress() {
  if (is_told_) print("\r\x1b[K");
}

void ReadingProgress::operator()(std::size_t done, std::size_t all) const {
  if (!is_told_) return;
  print("\rreading sessions: {} of {}", done, all);
  flush_output();
}

}  // namespace thermorig::app
