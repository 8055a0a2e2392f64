// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>

#include "thermorig/simulation/firmware.h"

namespace thermorig::simulation {

/// A servo with a motor of its own, which moves in steps of a millisecond: takes bytes and steps in the order
/// of time, and remembers where the shaft was.
class SteppedFirmware : public Firmware {
 public:
  void receive(std::uint8_t byte, std::int64_t time_us) override { coming_.push_back({time_us, byte}); }

  FirmwareOutput run_until(std::int64_t time_us) override {
    while (true) {
      const bool byte_is_next = !coming_.empty() && coming_.front().time_us <= next_step_us_;
      if (byte_is_next && coming_.front().time_us <= time_us)
        take_next_byte();
      else if (!byte_is_next && next_step_us_ <= time_us)
        take_next_step();
      else
        break;
    }
    FirmwareOutput output;
    while (!going_.empty() && going_.front().time_us <= time_us) {
      output.bytes.push_back(going_.front());
      going_.pop_front();
    }
    return output;
  }

  std::optional<double> shaft_deg(double time_us) const override {
    const double steps = std::max(0.0, (time_us - static_cast<double>(first_kept_us_)) / step_us);
    const auto before = std::min(static_cast<std::size_t>(steps), angles_deg_.size() - 1);
    const double share = steps - static_cast<double>(before);
    if (before + 1 == angles_deg_.size()) return angles_deg_.back() + rate_dps() * share * 1e-6 * step_us;
    return angles_deg_[before] + share * (angles_deg_[before + 1] - angles_deg_[before]);
  }

 protected:
  static constexpr std::int64_t step_us = 1000;

  explicit SteppedFirmware(std::uint32_t baud) : byte_us_(1e7 / baud) {}
  /// Where the shaft is before the first step: to be said by the constructor.
  void begin_at(double angle_deg) { angles_deg_.push_back(angle_deg); }

  virtual void take(const UartByte& byte) = 0;
  /// The motion of the step that ends at `now_us`.
  virtual void step(std::int64_t now_us) = 0;
  /// Of the shaft, after the last step.
  virtual double angle_deg() const = 0;
  virtual double rate_dps() const = 0;

  /// Puts the bytes on the line, when it is free, at `from_us` at the soonest.
  void transmit(std::span<const std::uint8_t> bytes, double from_us) {
    line_free_us_ = std::max(line_free_us_, from_us);
    for (const std::uint8_t byte : bytes) {
      going_.push_back({static_cast<std::int64_t>(std::ceil(line_free_us_)), byte});
      line_free_us_ += byte_us_;
    }
  }

 private:
  static constexpr std::size_t kept_steps = 700;

  void take_next_byte() {
    const UartByte byte = coming_.front();
    coming_.pop_front();
    take(byte);
  }
  void take_next_step() {
    step(next_step_us_);
    angles_deg_.push_back(angle_deg());
    if (angles_deg_.size() > kept_steps) {
      angles_deg_.pop_front();
      first_kept_us_ += step_us;
    }
    next_step_us_ += step_us;
  }

  double byte_us_;
  std::deque<UartByte> coming_, going_;
  double line_free_us_ = 0.0;
  std::int64_t next_step_us_ = step_us, first_kept_us_ = 0;
  std::deque<double> angles_deg_;
};

}  // namespace thermorig::simulation
