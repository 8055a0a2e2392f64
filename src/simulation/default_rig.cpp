// SPDX-License-Identifier: MIT
#include "thermorig/simulation/virtual_rig.h"

namespace thermorig::simulation {

namespace {
constexpr double unfiltered_gyro_hz = 8000.0;  // the widest that a profile can state: no delay to speak of
}

RigProfile default_profile() {
  RigProfile profile;
  profile.name = "simulated rig";
  // What a careful owner can know without measuring: the bridge reads 832 words over I2C and computes, about
  // 20 ms, and the pixels lag about 12 ms behind what they see; a gyro sample stands for the middle of its
  // interval and leaves about 1 ms after its end; telemetry leaves at once. The simulated devices differ from
  // these figures, each rig in its own way.
  profile.camera.link.latency_s = 0.032;
  profile.gyro.link.latency_s = 0.5 / profile.gyro.output_rate_hz + 0.001;
  profile.gyro.bandwidth_hz = unfiltered_gyro_hz;
  profile.servo.link.latency_s = 0.0;
  return profile;
}

VirtualRigConfig default_rig(std::uint64_t seed, const std::string& environment) {
  VirtualRigConfig config;
  config.seed = seed;
  config.environment = environment;
  config.profile = default_profile();
  // The bridge board carries a CH340; gyro and servo hang on FTDI cables with the driver's own 16 ms.
  config.links[Device::camera].kind = UsbLink::ch340;
  config.links[Device::gyro].kind = UsbLink::ftdi;
  config.links[Device::servo].kind = UsbLink::ftdi;
  return config;
}

std::unique_ptr<Firmware> make_servo(const VirtualRigConfig& config) {
  const ServoProfile& servo = config.profile.servo;
  if (servo.protocol == "dynamixel")
    return make_dynamixel(static_cast<std::uint8_t>(servo.bus_id), servo.link.baud, config.seed,
                          config.dynamixel);
  if (servo.protocol == "grbl") return make_grbl(servo.link.baud, config.seed, config.grbl);
  return make_host_firmware();
}

void put_in_world(const World& world, VirtualRigConfig& config) {
  config.world = world;
  if (world.gyro.bandwidth_hz != World().gyro.bandwidth_hz) config.profile.gyro.bandwidth_hz = 0.0;
}

}  // namespace thermorig::simulation
