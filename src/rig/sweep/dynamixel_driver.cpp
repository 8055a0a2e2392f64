// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "bus_servo_driver.h"
#include "thermorig/core/error.h"
#include "thermorig/sensors/wire/dynamixel.h"

namespace thermorig::rig {

namespace {

namespace dynamixel = wire::dynamixel;
namespace at = wire::dynamixel::at;

constexpr std::uint8_t watchdog_20ms = 10;       // 200 ms: a busy host speaks in time, a dead one not
constexpr double one_turn_short_deg = 92'000.0;  // of the 256 turns either way that a goal may have
constexpr std::uint8_t crc_error = 3;
constexpr std::uint8_t error_mask = 0x7F;

constexpr BusRegisters dynamixel_registers{.every_id = dynamixel::every_id,
                                           .torque = at::torque_enable,
                                           .hardware_error = at::hardware_error,
                                           .profile = at::profile_acceleration,
                                           .goal = at::goal_position,
                                           .goal_bytes = 4,
                                           .position = at::present_position,
                                           .position_answer = 4,
                                           .telemetry = dynamixel::telemetry_begin,
                                           .telemetry_bytes = dynamixel::telemetry_bytes,
                                           .reach_deg = dynamixel::position_deg,
                                           .speed_dps = dynamixel::velocity_dps,
                                           .farthest_deg = one_turn_short_deg};

std::string error_text(std::uint8_t error) {
  constexpr std::array<const char*, 8> texts{
      "no error",           "it could not do it", "unknown instruction", "damaged",
      "value out of range", "wrong length",       "beyond limit",        "not now"};
  return error < texts.size() ? texts[error] : fmt::format("error {}", error);
}

std::int32_t counts(double angle_deg) {
  return static_cast<std::int32_t>(std::lround(angle_deg / dynamixel::position_deg)) +
         dynamixel::middle_position;
}

/// At least one unit: 0 would be as fast as it can.
std::int32_t units(double value, double unit) {
  return std::max<std::int32_t>(1, static_cast<std::int32_t>(std::lround(std::abs(value) / unit)));
}

/// Of the X series, in extended position mode. Its bus watchdog stops it where nobody speaks on the bus,
/// before it is at the end of its leg.
class DynamixelDriver final : public BusServoDriver {
 public:
  explicit DynamixelDriver(const ServoProfile& servo) : BusServoDriver(servo, dynamixel_registers) {}

 private:
  Data write_bytes(std::uint8_t id, std::uint16_t address, const Data& data) const override {
    return dynamixel::write(id, address, data);
  }
  Data read_bytes(std::uint16_t address, std::size_t bytes) const override {
    return dynamixel::read(id(), address, static_cast<std::uint16_t>(bytes));
  }
  Data leg_note(std::uint16_t leg) const override { return dynamixel::note(leg); }
  Data greeting(bool to_all) const override { return dynamixel::ping(to_all ? dynamixel::every_id : id()); }

  Data profile_block(double goal_deg, double rate_dps, double acceleration_dps2) const override {
    Data block;
    dynamixel::put_i32(units(acceleration_dps2, dynamixel::acceleration_dps2), block);
    dynamixel::put_i32(units(rate_dps, dynamixel::velocity_dps), block);
    dynamixel::put_i32(counts(goal_deg), block);
    return block;
  }

  /// The EEPROM bears so many writes: it is only written where it says otherwise.
  void set_up() override {
    constexpr std::size_t delay_to_mode = 4;  // and one more: an answer of 3 bytes would be a ping's
    read("its mode", at::return_delay, delay_to_mode, [this](const Data& data) {
      const std::uint8_t drive_mode = data[at::drive_mode - at::return_delay];
      std::vector<Step> changes;
      if (data[0] != 0) changes.push_back(writing("its return delay", at::return_delay, {0}));
      if ((drive_mode & dynamixel::time_based_profile) != 0)
        changes.push_back(writing("its drive mode", at::drive_mode,
                                  {static_cast<std::uint8_t>(drive_mode & ~dynamixel::time_based_profile)}));
      if (data[at::operating_mode - at::return_delay] != dynamixel::extended_position_mode)
        changes.push_back(
            writing("its operating mode", at::operating_mode, {dynamixel::extended_position_mode}));
      insert_next(changes);
    });
    read("its velocity limit", at::velocity_limit, 4, [this](const Data& data) {
      welcome_->limit_rate_dps = dynamixel::i32_at(data, 0) * dynamixel::velocity_dps;
    });
  }

  void watch(bool is_watching) override {
    push(writing("its watchdog", at::bus_watchdog, {is_watching ? watchdog_20ms : std::uint8_t{0}}));
  }
  unsigned watchdog_ms() const override { return 20 * watchdog_20ms; }

  /// One that was damaged is sent again. After its watchdog has tripped it takes no goal, which telemetry may
  /// not have said yet.
  bool accepts(std::uint8_t error) override {
    error &= error_mask;
    if (error != 0 && error != crc_error)
      refused(error_text(error),
              "compare the servo's section of the rig profile with the servo's limits (its velocity limit, "
              "register 44); no other program may hold its torque");
    return error == 0;
  }

  std::string hardware_text(std::uint8_t bits) const override {
    return names_of_bits(bits, {{0x01, "input voltage"},
                                {0x04, "overheating"},
                                {0x08, "encoder"},
                                {0x10, "electrical shock"},
                                {0x20, "overload"}});
  }
  std::string name() const override { return "Dynamixel"; }
  std::string how_it_rests() const override { return "its own watchdog stops it"; }
  std::string greeting_advice() const override {
    return "switch its supply on; thermorig ports finds its baud rate and its ID (new ones have 57600 and "
           "1); "
           "it must speak protocol 2.0";
  }
};

}  // namespace

std::unique_ptr<ServoDriver> make_dynamixel_driver(const ServoProfile& servo) {
  return std::make_unique<DynamixelDriver>(servo);
}

}  // namespace thermorig::rig
