// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "simulation/raw_mlx90640.h"
#include "thermorig/io/i2c_camera.h"

namespace thermorig::test {

/// A bus in memory with a clock of its own, on which bytes take their time, and an MLX90640 as its data sheet
/// describes it: a measurement each period, halves in turn, which overwrites the memory and sets the bit of
/// new data while the host may be reading.
class FakeBus final : public io::I2cBus {
 public:
  using Measure = std::function<simulation::RawMlx90640::HalfFrame(unsigned subpage)>;

  explicit FakeBus(Measure measure) : measure_(std::move(measure)) {
    write_eeprom(simulation::RawMlx90640(1).eeprom());
  }

  void write_eeprom(const simulation::RawMlx90640::Eeprom& words) {
    for (std::size_t i = 0; i < words.size(); ++i) memory[static_cast<std::uint16_t>(0x2400 + i)] = words[i];
  }

  int transfer(std::uint8_t device, std::span<const std::uint8_t> written,
               std::span<std::uint8_t> read) override {
    if (is_unplugged) return ENODEV;
    if (device != address) return pass_bytes(1), ENXIO;
    if (failures > 0) return --failures, pass_bytes(1), ENXIO;
    if (read.size() > longest_read) return EOPNOTSUPP;
    pass_bytes(1 + written.size());
    if (written.size() >= 2) pointer_ = static_cast<std::uint16_t>(written[0] << 8 | written[1]);
    if (written.size() >= 4) write(static_cast<std::uint16_t>(written[2] << 8 | written[3]));
    if (!read.empty()) pass_bytes(1);
    for (std::size_t i = 0; i + 1 < read.size(); i += 2) {
      pass_bytes(2);
      if (i == 800) pass(std::exchange(stall, {}));
      const std::uint16_t word = memory[pointer_];
      read[i] = static_cast<std::uint8_t>(word >> 8U);
      read[i + 1] = static_cast<std::uint8_t>(word & 0xFFU);
      if (pointer_ == 0x342C) memory[0x3C14] &= static_cast<std::uint16_t>(~0x0100U);
      pointer_ = static_cast<std::uint16_t>(pointer_ + address_step);
    }
    return 0;
  }

  void pass(HostDuration time) {
    now += time;
    while (now >= next_measurement) measure();
  }

  double bus_hz = 400e3;
  std::uint8_t address = 0x33;
  std::uint16_t address_step = 1;
  std::size_t longest_read = 4096;
  bool is_unplugged = false;
  HostDuration stall{};  // in the middle of the next long read
  int failures = 0;      // transfers from now on that are not answered
  HostTime now{}, next_measurement{std::chrono::milliseconds(37)};
  std::map<std::uint16_t, std::uint16_t> memory{{0x8000, 0}, {0x800D, 0x1901}};
  std::set<std::uint16_t> written_to;
  std::vector<HostTime> measured;  // when each measurement ended

 private:
  void pass_bytes(std::size_t bytes) { pass(from_s(9.0 * static_cast<double>(bytes) / bus_hz)); }

  void write(std::uint16_t word) {
    written_to.insert(pointer_);
    if (pointer_ == 0x8000)
      memory[0x8000] = static_cast<std::uint16_t>((memory[0x8000] & 7U) | (word & 0x38U));
    else
      memory[pointer_] = word;
  }

  void measure() {
    measured.push_back(next_measurement);
    if (address == 0x66) {
      const auto counts = static_cast<std::uint16_t>(1000 + measured.size());
      for (unsigned i = 0; i < frame_pixels; ++i) memory[static_cast<std::uint16_t>(0x342C + 2 * i)] = counts;
      memory[0x3C14] |= 0x0100U;
      next_measurement += std::chrono::milliseconds(125);
      return;
    }
    const auto words = measure_(subpage_);
    for (std::size_t place = 0; place < words.size() - 2; ++place) {
      const bool is_pixel = place < frame_pixels;
      if (is_pixel && subpage_of(place / frame_columns, place % frame_columns) != subpage_) continue;
      memory[static_cast<std::uint16_t>(0x0400 + place)] = words[place];
    }
    memory[0x8000] = static_cast<std::uint16_t>((memory[0x8000] & 0x30U) | 8U | subpage_);
    subpage_ ^= 1U;
    next_measurement += from_s(std::ldexp(2.0, -static_cast<int>((memory[0x800D] & 0x0380U) >> 7U)));
  }

  Measure measure_;
  std::uint16_t pointer_ = 0;
  unsigned subpage_ = 0;
};

}  // namespace thermorig::test
