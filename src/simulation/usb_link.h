// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "random.h"
#include "thermorig/simulation/virtual_rig.h"

namespace thermorig::simulation {

// From a device's UART to the program's read(). Times are rig time in nanoseconds. Nothing depends on how
// often the link is asked: the same bytes give the same reads, and no byte is lost, doubled, moved or early.

struct TimedByte {
  std::int64_t time_ns = 0;  // end of its stop bit
  std::uint8_t value = 0;
};

struct TimedBytes {
  std::int64_t time_ns = 0;
  std::vector<std::uint8_t> bytes;
};

/// The transmitting end of a serial line: 8N1, one byte after the other. Baud 0: all at once.
class UartLine {
 public:
  explicit UartLine(std::uint32_t baud);

  double byte_ns() const { return byte_ns_; }

  /// Time of the backlog that a message that is ready at `ready_ns` finds before it.
  std::int64_t backlog_ns(std::int64_t ready_ns) const;

  /// Appends the bytes, sent from `ready_ns` on or when the line is free, to `out`.
  void send(std::span<const std::uint8_t> bytes, std::int64_t ready_ns, std::vector<TimedByte>& out);

 private:
  double byte_ns_;
  double free_ns_ = 0.0;
};

/// The 1 ms grid on which a full-speed USB host asks its devices. It slides slowly against the other clocks.
class UsbFrames {
 public:
  explicit UsbFrames(Random& random);
  std::int64_t at_or_after(std::int64_t time_ns) const;

 private:
  double period_ns_;
  double phase_ns_;
};

/// A USB bridge: UART bytes in, transfers to the host's kernel out.
class UsbBridge {
 public:
  virtual ~UsbBridge() = default;

  /// Nothing but time passes up to and including `time_ns`: what is due by then goes to `out`.
  virtual void pass(std::int64_t time_ns, std::vector<TimedBytes>& out) = 0;

  /// The next byte; pass() has been called up to just before it.
  virtual void take(const TimedByte& byte, std::vector<TimedBytes>& out) = 0;
};

std::unique_ptr<UsbBridge> make_bridge(const LinkConfig& link, const UsbFrames& frames, Random& random);

/// The program's reading thread: wakes up some time after data came in, and takes all that is there by then,
/// at most 4096 bytes a read. On a loaded host some wake-ups come late.
class HostReader {
 public:
  HostReader(bool loaded, Random random) : loaded_(loaded), random_(random) {}

  void deliver(TimedBytes transfer) { waiting_.push_back(std::move(transfer)); }

  /// The reads that return by `until_ns`; all transfers up to then have been delivered.
  std::vector<TimedBytes> reads(std::int64_t until_ns);

 private:
  std::int64_t wake_up_ns();
  TimedBytes read_at(std::int64_t time_ns);

  bool loaded_;
  Random random_;
  std::vector<TimedBytes> waiting_;  // transfers in the kernel's buffer, and on their way
  std::size_t first_ = 0;            // of waiting_ that has not been read
  std::int64_t last_read_ns_ = 0;
  std::optional<std::int64_t> next_read_ns_;
};

/// Bridge and reader together.
class UsbPath {
 public:
  UsbPath(const LinkConfig& link, std::uint64_t seed, std::string_view name);

  /// Bytes from the device, in order, some of them still to come.
  void push(std::span<const TimedByte> bytes);

  /// The reads that return by `until_ns`. All bytes up to then have been pushed.
  std::vector<TimedBytes> reads(std::int64_t until_ns);

  /// When bytes that the program writes at `now_ns` begin on the device's line.
  std::int64_t outgoing_ns(std::int64_t now_ns) const { return frames_.at_or_after(now_ns); }

 private:
  Random random_;
  UsbFrames frames_;
  std::unique_ptr<UsbBridge> bridge_;
  HostReader reader_;
  std::vector<TimedByte> coming_;
  std::vector<TimedBytes> transfers_;
};

}  // namespace thermorig::simulation
