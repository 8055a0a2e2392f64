// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thermorig::io {

/// The device's side of a port that a program can open. Its end is the pulling of the plug.
class DeviceSide {
 public:
  virtual ~DeviceSide() = default;

  /// A descriptor to wait on for bytes of the program, -1 if there is none.
  virtual int fd() const = 0;

  /// Whether a program has the port open now.
  virtual bool is_open() = 0;

  /// How many bytes were written at once (0 while no program has it open); the rest is the caller's.
  virtual std::size_t write(std::span<const std::uint8_t> bytes) = 0;

  /// What the program wrote, up to 4096 bytes; empty if nothing waits.
  virtual std::vector<std::uint8_t> read() = 0;
};

}  // namespace thermorig::io
