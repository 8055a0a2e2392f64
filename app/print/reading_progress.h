// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

namespace thermorig::app {

/// Tells on a terminal how many sessions were read so far; elsewhere, and with --json, nothing. What it drew
/// is gone when it is.
class ReadingProgress {
 public:
  explicit ReadingProgress(bool json);
  ~ReadingProgress();
  ReadingProgress(const ReadingProgress&) = delete;
  ReadingProgress& operator=(const ReadingProgress&) = delete;

  void operator()(std::size_t done, std::size_t all) const;

 private:
  bool is_told_;
};

}  // namespace thermorig::app
