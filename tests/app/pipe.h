// SPDX-License-Identifier: MIT
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <array>
#include <string>
#include <utility>

#include "support/hand_clock.h"

namespace thermorig::tests {

/// A pipe that holds one page, and its reader. Texts for it are shorter than 400 bytes.
class Pipe {
 public:
  Pipe() {
    EXPECT_EQ(pipe2(ends_.data(), O_CLOEXEC), 0);
    EXPECT_GE(fcntl(ends_[1], F_SETPIPE_SZ, pipe_bytes), pipe_bytes);
  }
  ~Pipe() {
    close_reader();
    close(ends_[1]);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  int writer() const { return ends_[1]; }
  int reader() const { return ends_[0]; }
  void close_reader() {
    if (ends_[0] >= 0) close(std::exchange(ends_[0], -1));
  }

  /// All that comes until `marker` has come.
  std::string read_until(const std::string& marker) const {
    std::string text;
    std::array<char, 512> part{};
    while (text.find(marker) == std::string::npos) {
      const ssize_t count = read(ends_[0], part.data(), part.size());
      if (count <= 0) break;
      text.append(part.data(), static_cast<std::size_t>(count));
    }
    return text;
  }

  /// Waits until it has no room for one more text.
  bool fills() const {
    return comes_true([this] {
      int bytes = 0;
      return ioctl(ends_[0], FIONREAD, &bytes) == 0 && bytes > pipe_bytes - text_bytes_max;
    });
  }

  /// What is in it now.
  std::string rest() const {
    fcntl(ends_[0], F_SETFL, O_NONBLOCK);
    return read_until("no such text");
  }

 private:
  static constexpr int pipe_bytes = 4096, text_bytes_max = 400;
  std::array<int, 2> ends_{};
};

}  // namespace thermorig::tests
