// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "thermorig/core/profile.h"
#include "thermorig/simulation/firmware.h"

namespace thermorig::simulation {

/// A micro-controller that follows a written angle over time with a pulse every 20 ms, answers every byte
/// with its successor, and notes when bytes came.
class ScriptedFirmware : public Firmware {
 public:
  using Angle = std::function<double(double time_s)>;

  explicit ScriptedFirmware(Angle angle_deg, ServoProfile servo = {})
      : angle_deg_(std::move(angle_deg)), servo_(std::move(servo)) {}

  void receive(std::uint8_t byte, std::int64_t time_us) override {
    received.push_back({time_us, byte});
    answers_.push_back({time_us, static_cast<std::uint8_t>(byte + 1)});
  }

  FirmwareOutput run_until(std::int64_t time_us) override {
    FirmwareOutput out;
    out.bytes = std::exchange(answers_, {});
    for (; angle_deg_; next_rise_us_ += 20000) {
      const double middle_us = (servo_.pulse_min_us + servo_.pulse_max_us) / 2.0;
      const double us_per_deg = (servo_.pulse_max_us - servo_.pulse_min_us) / servo_.travel_deg;
      const double width_us = middle_us + us_per_deg * angle_deg_(static_cast<double>(next_rise_us_) * 1e-6);
      if (static_cast<double>(next_rise_us_) + width_us > static_cast<double>(time_us)) break;
      out.pulses.push_back({next_rise_us_, width_us});
    }
    return out;
  }

  std::string description() const override { return "script"; }

  std::vector<UartByte> received;

 private:
  Angle angle_deg_;
  ServoProfile servo_;
  std::int64_t next_rise_us_ = 0;
  std::vector<UartByte> answers_;
};

}  // namespace thermorig::simulation
