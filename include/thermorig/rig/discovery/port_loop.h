// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "thermorig/core/profile.h"
#include "thermorig/core/time.h"
#include "thermorig/io/find_again.h"
#include "thermorig/io/port.h"

namespace thermorig::rig {

/// Ports, a timer and signals on one thread, and the clock that belongs to them: whoever has ports that are
/// none of this computer's (a test, in virtual time) implements this. Each member does what the one of
/// io::Loop does, or the function in io that has its name.
class PortLoop {
 public:
  using PortId = io::Loop::PortId;
  using PortHandlers = io::Loop::PortHandlers;

  virtual ~PortLoop() = default;
  virtual HostTime now() const = 0;
  virtual PortId open(const PortProfile& link, PortHandlers handlers, io::Refusal refusal) = 0;
  virtual void write(PortId port, std::span<const std::uint8_t> bytes) = 0;
  virtual void keep_emergency_bytes(PortId port, std::span<const std::uint8_t> bytes) = 0;
  virtual void close(PortId port) = 0;
  virtual void every(HostDuration period, std::function<void(HostTime)> tick) = 0;
  virtual void on_signal(std::function<void(int signal)> handler) = 0;
  virtual void run() = 0;
  virtual void stop() = 0;
  /// Neither a pseudo terminal has one nor an I2C bus.
  virtual bool has_baud(const std::string& port) const = 0;
  virtual io::KnownPort know_port(const std::string& name) const = 0;
  virtual std::optional<std::string> find_again(const io::KnownPort& port,
                                                const std::vector<io::KnownPort>& others) const = 0;
};

/// The ports of this computer, its clock and the signals to this process.
class SystemPortLoop : public PortLoop {
 public:
  HostTime now() const override;
  PortId open(const PortProfile& link, PortHandlers handlers, io::Refusal refusal) override;
  void write(PortId port, std::span<const std::uint8_t> bytes) override;
  void keep_emergency_bytes(PortId port, std::span<const std::uint8_t> bytes) override;
  void close(PortId port) override;
  void every(HostDuration period, std::function<void(HostTime)> tick) override;
  void on_signal(std::function<void(int signal)> handler) override;
  void run() override;
  void stop() override;
  bool has_baud(const std::string& port) const override;
  io::KnownPort know_port(const std::string& name) const override;
  std::optional<std::string> find_again(const io::KnownPort& port,
                                        const std::vector<io::KnownPort>& others) const override;

 private:
  io::Loop loop_;
};

}  // namespace thermorig::rig
