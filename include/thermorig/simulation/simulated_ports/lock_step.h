// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

/// What thermorig and thermorig-avr say to each other over the latter's standard input and output. Both run
/// on one machine, so numbers are in its own byte order.
///
///   thermorig      RunRequest, then `bytes` TimedByte in order of time: they arrive whole at their times
///   thermorig-avr  runs the image until `until_us` after its reset
///   thermorig-avr  RunReply, then `bytes` TimedByte (time: start bit), then `pulses` TimedPulse, then
///   `writes`
///                  RegisterByte: what was written to the sensor
///
/// and so on. thermorig-avr ends when its input is closed.
namespace thermorig::lock_step {

/// An AS5600 on the I2C, at 0x36, until the next request.
struct Sensor {
  std::uint8_t is_there = 0;  // 0: nothing answers at any address
  std::uint8_t bus = 0;       // 0 answers, 1 acknowledges nothing, 2 what is read are ones
  std::uint8_t status = 0, gain = 0;
  std::uint16_t raw = 0;
  std::uint16_t unused = 0;
};

struct RunRequest {
  std::int64_t until_us = 0;
  std::uint64_t bytes = 0;
  Sensor sensor;
};

struct RegisterByte {
  std::uint8_t address = 0, value = 0;
};

struct TimedByte {
  std::int64_t time_us = 0;
  std::uint64_t value = 0;
};

struct TimedPulse {
  std::int64_t rise_us = 0;
  double width_us = 0.0;
};

struct RunReply {
  std::uint64_t bytes = 0;
  std::uint64_t pulses = 0;
  std::uint64_t writes = 0;
};

}  // namespace thermorig::lock_step
