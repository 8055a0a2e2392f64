// SPDX-License-Identifier: MIT
#include "served_rig.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <thread>

#include "thermorig/rig/profile/profile_file.h"

namespace thermorig::tests {

namespace {

class WatchedFirmware : public simulation::Firmware {
 public:
  WatchedFirmware(std::unique_ptr<simulation::Firmware> firmware, std::shared_ptr<ServoDecoder> line)
      : firmware_(std::move(firmware)), line_(std::move(line)) {}

  void receive(std::uint8_t byte, std::int64_t time_us) override {
    line_->received.push_back({time_us, byte});
    firmware_->receive(byte, time_us);
  }
  simulation::FirmwareOutput run_until(std::int64_t time_us) override {
    line_->now_us = time_us;
    simulation::FirmwareOutput output = firmware_->run_until(time_us);
    for (const simulation::PulseEdge& pulse : output.pulses) {
      if (!line_->pulses.empty() && line_->pulses.back().width_us != pulse.width_us)
        line_->turned_us = pulse.rise_us;
      line_->pulses.push_back(pulse);
    }
    return output;
  }
  std::string description() const override { return firmware_->description(); }

 private:
  std::unique_ptr<simulation::Firmware> firmware_;
  std::shared_ptr<ServoDecoder> line_;
};

}  // namespace

ServedRig::ServedRig(std::uint64_t seed, const std::string& environment)
    : config_(simulation::default_rig(seed, environment)), line_(std::make_shared<ServoDecoder>()) {
  ports_ = std::make_unique<SimulatedPorts>(
      config_, std::make_unique<WatchedFirmware>(make_firmware(FirmwareChoice::avr_image), line_));
  if (ports_->firmware_description() != "AVR image")
    std::cout << "thermorig-avr or the AVR image is not built: tested with the firmware's host build\n";
  ports_->keep_truth();
  ports_->start();
}

void ServedRig::write_profile(const std::filesystem::path& path) const {
  RigProfile profile = config_.profile;
  for (const Device device : all_devices) profile.link(device).port = ports_->paths()[device];
  rig::write_profile(path, profile);
}

void ServedRig::let_pass(std::int64_t mcu_us) const {
  const std::int64_t until_us = line_->now_us + mcu_us;
  while (line_->now_us < until_us) std::this_thread::sleep_for(std::chrono::milliseconds(2));
}

double ServedRig::fastest_dps(std::int64_t from_us, std::int64_t to_us) const {
  const auto& shaft = ports_->rig().shaft();  // a sample a millisecond, the first one a millisecond after 0
  double fastest = 0.0;
  for (std::size_t i = 0; i < shaft.size(); ++i) {
    const auto time_us = static_cast<std::int64_t>(1000 * (i + 1));
    if (time_us >= from_us && time_us <= to_us) fastest = std::max(fastest, std::abs(shaft[i].rate_dps));
  }
  return fastest;
}

std::int64_t ServedRig::last_motion_us(double rate_dps, std::int64_t until_us) const {
  const auto& shaft = ports_->rig().shaft();
  for (std::size_t i = shaft.size(); i-- > 0;) {
    const auto time_us = static_cast<std::int64_t>(1000 * (i + 1));
    if (time_us <= until_us && std::abs(shaft[i].rate_dps) >= rate_dps) return time_us;
  }
  return 0;
}

}  // namespace thermorig::tests
