// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace thermorig::rig::test {

/// What a board's boot loader does instead of what it should.
enum class BootFault : std::uint8_t { none, silent, other_chip, stops_answering };

/// A board with an ATmega328P on a pseudo terminal, whose boot loader waits to be talked to: the part of
/// STK500 version 1 that optiboot has. A pseudo terminal has no DTR, by which avrdude resets a board: avrdude
/// says so (TIOCMGET) and goes on, and this boot loader is always there. At another speed than its own it
/// hears other bytes and answers with such.
class BootLoader {
 public:
  /// `on_page`: called on its thread before it answers to a page.
  explicit BootLoader(int baud, BootFault fault = BootFault::none,
                      std::function<void(int page)> on_page = {});
  ~BootLoader();
  BootLoader(const BootLoader&) = delete;
  BootLoader& operator=(const BootLoader&) = delete;

  const std::string& path() const { return path_; }
  /// avrdude is done with it: what was flashed begins.
  bool has_left() const { return has_left_; }
  /// What the board holds, as Intel HEX. When it has left.
  std::string hex() const;
  int pages() const { return pages_; }

 private:
  struct Unplugged {};
  struct Restarted {};  // by its watchdog: a command that is not whole
  void serve();
  void answer(std::uint8_t command);
  std::optional<std::uint8_t> next(int patience_ms);
  std::vector<std::uint8_t> rest(int count);
  void send(std::vector<std::uint8_t> bytes) const;
  bool is_at_its_speed() const;

  int baud_;
  BootFault fault_;
  std::function<void(int)> on_page_;
  int ours_ = -1;  // the other end is nobody's: a port that another program has open is refused
  std::string path_;
  std::vector<std::uint8_t> flash_;
  std::size_t address_ = 0;
  std::atomic<int> pages_{0};
  std::atomic<bool> is_over_{false}, has_left_{false};
  std::thread thread_;
};

}  // namespace thermorig::rig::test
