// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <memory>

namespace thermorig::io {

/// Tells when a terminal (or a socket) has something to read, from a thread of its own.
///
/// To ask a terminal may take long: Linux answers a poll of one that is empty only when a worker of the
/// kernel has carried to it what is under way (n_tty_poll, flush_work), and on a computer that has more to do
/// than processors that has taken seconds. Whoever asks waits, so nobody asks who has other ports to read and
/// a servo to stop. read() does not wait where something is there to be read.
class ReadWatch {
 public:
  /// `readable` is called by the thread: soon after bytes have come or the terminal has hung up, and then no
  /// more before again(). `fd` stays open for as long as this exists.
  ReadWatch(int fd, std::function<void()> readable);
  /// From then on nothing is called. Waits for the thread only while it asks for the first time.
  ~ReadWatch();
  ReadWatch(const ReadWatch&) = delete;
  ReadWatch& operator=(const ReadWatch&) = delete;

  /// What comes from now on is told of; what came before is the caller's to read.
  void again();

  /// Whether the other end is known to be gone: then read() does not wait, and tells so after the last byte.
  bool has_hung_up() const;

 private:
  struct Shared;
  static void run(Shared& shared, int fd);

  std::shared_ptr<Shared> shared_;  // with the thread, whichever ends last
};

}  // namespace thermorig::io
