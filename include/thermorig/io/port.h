// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "thermorig/core/chunk.h"
#include "thermorig/core/profile.h"
#include "thermorig/core/time.h"
#include "thermorig/io/device_side.h"
#include "thermorig/io/files/descriptor.h"

namespace thermorig::io {

/// The only reading of the steady clock in the program (CLOCK_MONOTONIC).
HostTime now();
/// CLOCK_REALTIME - CLOCK_MONOTONIC, nanoseconds.
std::int64_t realtime_offset_ns();
/// "2026-07-25T14:35:12.123456Z" for a host time.
std::string utc_text(HostTime time, std::int64_t realtime_offset_ns);

/// A port as the operating system lists it.
struct PortInfo {
  std::string path;         // /dev/ttyUSB0
  std::string description;  // device strings, control characters stripped
  std::string usb_path;     // topology "1-4.2"; empty if not USB
  std::string usb_id;       // "1a86:7523"; empty if not USB
  std::string serial;
  std::string usb_interface;  // "1.1": configuration and interface, for adapters with several ports
};
/// All serial ports, by path, and the I2C buses on which a camera answers. A port that the kernel uses as its
/// console is left out.
std::vector<PortInfo> list_ports();

/// The device file behind a port's name: links (by-id, by-path) are followed, "ttyUSB0" stands for
/// "/dev/ttyUSB0". Throws Error(device_missing), which lists the ports that exist, if there is no such port.
std::string resolve_port(const std::string& port);

/// True if `port` leads to a pseudo terminal: no wire, no baud rate, and a program in place of a device.
bool is_pseudo_terminal(const std::string& port);

/// True if `port` leads to an I2C bus of this computer ("/dev/i2c-1"), whether or not it is there: a port
/// with a camera, whose bytes are those of protocols/mlx_raw.md.
bool is_i2c_bus(const std::string& port);

/// How a port that is in use is refused: who holds it takes a walk through all processes, which also finds
/// those who read it without a lock.
enum class Refusal : std::uint8_t { names_holder, brief };

/// A loop on one thread: ports are read, the timer ticks, signals arrive. Every handler is called inside
/// run() and may call any member. An exception that a handler throws leaves run(), which may then be called
/// again.
class Loop {
 public:
  Loop();
  ~Loop();
  Loop(const Loop&) = delete;

  using PortId = std::size_t;
  struct PortHandlers {
    std::function<void(std::span<const std::uint8_t>, HostTime)> received;  // time taken right after read()
    std::function<void(const std::string& why)> lost;  // unplugged or failed; called once, the last call
  };

  /// Opens a port exclusively (flock; real ports TIOCEXCL as well), raw 8N1 at link.baud, which a pty
  /// ignores. Bytes that arrived before are thrown away. An I2C bus is read from a thread of its own, until
  /// close(). Throws Error: device_missing (no such port, not a serial port, baud refused), no_permission
  /// (not allowed, in use and by whom, or the system's console).
  PortId open(const PortProfile& link, PortHandlers handlers, Refusal refusal = Refusal::names_holder);

  /// Serves what is open already and non-blocking: a terminal that was set up, a socket (whose SIGPIPE,
  /// where its other end is gone, is the caller's matter).
  PortId attach(files::Descriptor port, PortHandlers handlers);

  /// Queues bytes; they are written in order. Writing to a lost port does nothing.
  void write(PortId port, std::span<const std::uint8_t> bytes);

  /// Bytes that the port gets whatever ends the program, if close() was not called before: emergency_bytes.h.
  void keep_emergency_bytes(PortId port, std::span<const std::uint8_t> bytes);

  /// Closes a port: none of its handlers is called any more, bytes still queued are dropped.
  void close(PortId port);

  /// Calls `tick` every `period` until it is replaced. Ticks that are missed are left out, not made up for.
  void every(HostDuration period, std::function<void(HostTime)> tick);

  /// SIGINT, SIGTERM and SIGHUP call `handler` inside run() instead of ending the program.
  void on_signal(std::function<void(int signal)> handler);

  /// Runs until stop().
  void run();
  /// May be called from handlers and from other threads. A stop before run() makes run() return at once.
  void stop();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A pseudo terminal that a program can open as a port; this side plays the device. As long as no program has
/// it open, bytes written to it are lost, as those of a device on a port that nobody reads; so is what finds
/// no room, if the caller drops it, like an overrun.
class Pty final : public DeviceSide {
 public:
  /// Throws Error(failed) when the system has no pseudo terminals left.
  Pty();
  ~Pty() override;
  Pty(Pty&&) noexcept;
  Pty& operator=(Pty&&) noexcept;
  const std::string& path() const;  // /dev/pts/N
  int fd() const override;          // the device's side, non-blocking; -1 when unplugged
  bool is_open() override;
  std::size_t write(std::span<const std::uint8_t> bytes) override;
  std::vector<std::uint8_t> read() override;
  void unplug();  // closes the device's side

 private:
  std::string path_;
  int master_ = -1;
  bool was_open_ = false;
};

}  // namespace thermorig::io
