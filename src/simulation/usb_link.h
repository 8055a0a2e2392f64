// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
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
  /// `baud_error`: relative; the line is faster by so much.
  explicit UartLine(std::uint32_t baud, double baud_error = 0.0);

  double byte_ns() const { return byte_ns_; }

  /// Time of the backlog that a message that is ready at `ready_ns` finds before it.
  std::int64_t backlog_ns(std::int64_t ready_ns) const;

  /// Appends the bytes, sent from `ready_ns` on or when the line is free, to `out`.
  void send(std::span<const std::uint8_t> bytes, std::int64_t ready_ns, std::vector<TimedByte>& out);

 private:
  double byte_ns_;
  double free_ns_ = 0.0;
};

/// A number from 0 to 1 for each slot of time, drawn evenly, whoever asks and when.
class SlotDraws {
 public:
  SlotDraws(std::uint64_t seed, std::string stream) : seed_(seed), stream_(std::move(stream)) {}
  double at(std::int64_t slot) const;

 private:
  std::uint64_t seed_;
  std::string stream_;
};

/// The 1 ms grid on which a full-speed USB host asks its devices. It slides slowly against the other clocks.
class UsbFrames {
 public:
  /// `jitter_ns`: a device is asked up to so much, at most 1 ms, after its frame's begin.
  explicit UsbFrames(Random& random, double jitter_ns = 0.0, SlotDraws draws = {0, ""});
  std::int64_t at_or_after(std::int64_t time_ns) const;

 private:
  double period_ns_;
  double phase_ns_;
  double jitter_ns_;
  SlotDraws draws_;
};

/// What all ports of a computer share: the hub that they hang on, and times at which it reads none of them.
class SharedBus {
 public:
  SharedBus(const LinksWorld& world, std::uint64_t seed);

  /// When a transfer that the hub gets at `time_ns` is at the host.
  std::int64_t behind_hub_ns(std::int64_t time_ns) const;

  /// `time_ns`, or the end of the stall in which it lies.
  std::int64_t after_stall_ns(std::int64_t time_ns) const;

 private:
  LinksWorld world_;
  SlotDraws jitter_, stall_begins_, stall_lengths_;
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
  /// `late`: draws how late reads are by `read_delay_s` on average.
  HostReader(bool loaded, Random random, const SharedBus& bus, double read_delay_s, Random late)
      : loaded_(loaded), random_(random), bus_(bus), read_delay_s_(read_delay_s), late_(late) {}

  void deliver(TimedBytes transfer) { waiting_.push_back(std::move(transfer)); }

  /// The reads that return by `until_ns`; all transfers up to then have been delivered.
  std::vector<TimedBytes> reads(std::int64_t until_ns);

 private:
  std::int64_t wake_up_ns();
  TimedBytes read_at(std::int64_t time_ns);

  bool loaded_;
  Random random_;
  SharedBus bus_;
  double read_delay_s_;
  Random late_;
  std::vector<TimedBytes> waiting_;  // transfers in the kernel's buffer, and on their way
  std::size_t first_ = 0;            // of waiting_ that has not been read
  std::int64_t last_read_ns_ = 0;
  std::optional<std::int64_t> next_read_ns_;
};

/// Bridge and reader together.
class UsbPath {
 public:
  UsbPath(const LinkConfig& link, std::uint64_t seed, std::string_view name, const LinksWorld& world = {});

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
  SharedBus bus_;
  HostReader reader_;
  std::int64_t delivered_ns_ = 0;  // the transfer before
  std::vector<TimedByte> coming_;
  std::vector<TimedBytes> transfers_;
};

}  // namespace thermorig::simulation
