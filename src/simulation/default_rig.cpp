// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "thermorig/core/error.h"
#include "thermorig/simulation/virtual_rig.h"

namespace thermorig::simulation {

namespace {
constexpr std::array<std::string_view, 7> all_camera_kinds{"half",   "full", "query", "text",
                                                           "binary", "raw",  "i2c"};
constexpr std::uint32_t stick_baud = 1'000'000;  // USB alone
constexpr std::uint32_t i2c_bus_baud = 444'444;  // 400 kHz, nine bits a byte
constexpr double i2c_poll_s = 0.0005;            // a sensor is asked each millisecond whether it has measured
constexpr double i2c_stated_latency_s = 0.0135;  // that, and the lag of its pixels
constexpr double unfiltered_gyro_hz = 8000.0;    // the widest that a profile can state: no delay to speak of
}  // namespace

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
  const auto id = static_cast<std::uint8_t>(servo.bus_id);
  if (servo.protocol == "dynamixel")
    return make_dynamixel(id, servo.link.baud, config.seed, config.dynamixel, config.world.servo);
  if (servo.protocol == "sts3215")
    return make_sts3215(id, servo.link.baud, config.seed, config.sts3215, config.world.servo);
  if (servo.protocol == "grbl")
    return make_grbl(servo.link.baud, config.seed, config.grbl, config.world.servo);
  return make_host_firmware();
}

bool measures_shaft(const VirtualRigConfig& config) {
  const std::string& protocol = config.profile.servo.protocol;
  if (protocol == ServoProfile().protocol) return config.has_encoder;
  return protocol == "dynamixel" || protocol == "sts3215";
}

void put_in_world(const World& world, VirtualRigConfig& config) {
  config.world = world;
  if (world.gyro.bandwidth_hz != World().gyro.bandwidth_hz) config.profile.gyro.bandwidth_hz = 0.0;
}

std::span<const std::string_view> camera_kinds() {
  return all_camera_kinds;
}

void choose_camera(std::string_view kind, VirtualRigConfig& config) {
  if (std::find(all_camera_kinds.begin(), all_camera_kinds.end(), kind) == all_camera_kinds.end())
    throw Error(ExitCode::bad_usage, fmt::format("there is no simulated camera \"{}\"", kind), "",
                fmt::format("{}", fmt::join(all_camera_kinds, ", ")));
  CameraProfile& camera = config.profile.camera;
  const bool is_sketch = kind == "text" || kind == "binary";  // which merges both halves
  config.half_fresh = kind != "full" && !is_sketch;
  if (kind == "query" || kind == "raw" || kind == "i2c") config.camera_start = CameraStart::when_asked;
  if (is_sketch) camera.protocol = kind;
  if (kind == "raw") {
    camera.protocol = "i2c-stick";
    camera.link.baud = stick_baud;
  }
  if (kind == "i2c") {  // of the computer: nothing computes between its exposure and its first byte
    camera.protocol = "mlx-raw";
    camera.link.baud = 0;
    camera.link.latency_s = i2c_stated_latency_s;
    config.camera_bus_baud = i2c_bus_baud;
    config.camera_latency_s = 1e-3 * config.world.camera.membrane_lag_ms + i2c_poll_s;
    config.links[Device::camera].kind = UsbLink::cdc;
  }
}

}  // namespace thermorig::simulation
