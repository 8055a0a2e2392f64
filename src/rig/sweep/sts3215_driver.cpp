// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "bus_servo_driver.h"
#include "thermorig/core/error.h"
#include "thermorig/rig/sweep/plan.h"
#include "thermorig/sensors/wire/sts3215.h"

namespace thermorig::rig {

namespace {

namespace sts3215 = wire::sts3215;
namespace cell = wire::sts3215::at;

constexpr double rated_dps = 270.0;    // 0.222 s for 60 deg at 12 V: data sheet of the ST-3215-C018
constexpr double sts_reach_deg = 4.5;  // its gear has play, and a load pushes it off its goal
constexpr double sts_farthest_deg =
    (sts3215::farthest_position - sts3215::middle_position) * sts3215::position_deg;

constexpr BusRegisters sts3215_registers{.every_id = sts3215::every_id,
                                         .torque = cell::torque_enable,
                                         .hardware_error = cell::status,
                                         .profile = cell::acceleration,
                                         .goal = cell::goal_position,
                                         .goal_bytes = 2,
                                         .position = cell::present_position,
                                         .position_answer = sts3215::position_bytes,
                                         .telemetry = sts3215::telemetry_begin,
                                         .telemetry_bytes = sts3215::telemetry_bytes,
                                         .reach_deg = sts_reach_deg,
                                         .speed_dps = sts3215::position_deg,
                                         .farthest_deg = sts_farthest_deg};

/// In position mode, over several turns. It has no watchdog: a leg ends at its goal.
class Sts3215Driver final : public BusServoDriver {
 public:
  explicit Sts3215Driver(const ServoProfile& servo) : BusServoDriver(servo, sts3215_registers) {
    const double most_dps2 = sts3215::most_acceleration * sts3215::acceleration_dps2;
    if (servo.acceleration_dps2 > most_dps2)
      throw Error(ExitCode::bad_usage,
                  fmt::format("an STS3215 accelerates by {:.0f} deg/s^2 at most, the rig profile says {:.0f}",
                              most_dps2, servo.acceleration_dps2),
                  "servo",
                  fmt::format("acceleration_dps2 = {:.0f} or less in [servo] of the rig profile", most_dps2));
    const auto limit_deg = angle_limit_deg(servo);
    if (!limit_deg || *limit_deg > sts_farthest_deg)
      throw Error(ExitCode::bad_usage,
                  fmt::format("an STS3215 turns to {:.0f} deg either way and no further", sts_farthest_deg),
                  "servo",
                  fmt::format("kind = \"positional\" and travel_deg = {:.0f} or less in [servo] of the rig "
                              "profile",
                              std::floor(2.0 * sts_farthest_deg / 10.0) * 10.0));
  }

 private:
  Data write_bytes(std::uint8_t id, std::uint16_t address, const Data& data) const override {
    return sts3215::write(id, address, data);
  }
  Data read_bytes(std::uint16_t address, std::size_t bytes) const override {
    return sts3215::read(id(), address, bytes);
  }
  Data leg_note(std::uint16_t leg) const override { return sts3215::note(leg); }
  Data greeting(bool to_all) const override {
    return to_all ? sts3215::ping(sts3215::every_id)
                  : sts3215::read(id(), cell::firmware, sts3215::identity_bytes);
  }

  /// Acceleration, goal, a time that is not used, speed. At least one unit: 0 would be as fast as it can.
  Data profile_block(double goal_deg, double rate_dps, double acceleration_dps2) const override {
    const auto counts = [](double value_deg) {
      return static_cast<std::int32_t>(std::lround(value_deg / sts3215::position_deg));
    };
    const long acceleration = std::lround(acceleration_dps2 / sts3215::acceleration_dps2);
    Data block{static_cast<std::uint8_t>(std::clamp<long>(acceleration, 1, sts3215::most_acceleration))};
    sts3215::put_signed(counts(goal_deg) + sts3215::middle_position, block);
    sts3215::put_signed(0, block);
    sts3215::put_signed(std::max(1, counts(std::abs(rate_dps))), block);
    return block;
  }

  void look_first() override {
    read("whether it answers", cell::answers, 1, [](const Data& data) {
      if (data[0] == 0)
        throw Error(ExitCode::device_missing, "the servo does not answer what is written to it", "servo",
                    "set register 8 (response status level) to 1 with the maker's tool");
    });
  }

  /// The EEPROM bears so many writes: it is only written where it says otherwise.
  void set_up() override {
    read("its settings", cell::return_delay, sts3215::setting_bytes, [this](const Data& data) {
      const auto at = [&](std::uint16_t address) { return data[address - cell::return_delay]; };
      std::vector<Step> changes;
      if (at(cell::return_delay) != 0)
        changes.push_back(writing("its return delay", cell::return_delay, {0}));
      const bool has_limits = std::any_of(data.begin() + cell::least_angle - cell::return_delay,
                                          data.begin() + cell::least_angle - cell::return_delay + 4,
                                          [](std::uint8_t byte) { return byte != 0; });
      if (has_limits) changes.push_back(writing("its limits of angle", cell::least_angle, {0, 0, 0, 0}));
      if ((at(cell::phase) & sts3215::phase_counts_turns) == 0)
        changes.push_back(
            writing("its phase", cell::phase,
                    {static_cast<std::uint8_t>(at(cell::phase) | sts3215::phase_counts_turns)}));
      if (changes.empty()) return;
      changes.insert(changes.begin(), writing("its lock", cell::lock, {0}));
      changes.push_back(writing("its lock", cell::lock, {1}));
      insert_next(changes);
    });
    read("its mode", cell::mode, 1, [](const Data& data) {
      if (data[0] != 0)
        throw Error(ExitCode::device_missing,
                    fmt::format("the servo is in mode {}, not in position mode", data[0]), "servo",
                    "set register 33 (operation mode) to 0 with the maker's tool");
    });
  }

  void welcomed() override {
    if (welcome_->version != sts3215::model_of_4096)
      throw Error(
          ExitCode::device_missing,
          fmt::format("this is not an STS3215 but another servo of its maker: {}", welcome_->firmware),
          "servo", "STS servos with 4096 counts a turn are driven: STS3215, STS3250");
    welcome_->version = 0;
    welcome_->limit_rate_dps = rated_dps;
  }

  bool accepts(std::uint8_t error) override {
    if (const std::string why = hardware_text(error); !why.empty()) motor_is_off(why);
    return true;
  }
  std::string hardware_text(std::uint8_t bits) const override {
    return names_of_bits(
        bits & sts3215::giving_way,
        {{0x02, "sensor of the angle"}, {0x04, "overheating"}, {0x08, "current"}, {0x20, "overload"}});
  }
  std::string name() const override { return "STS3215"; }
  std::string how_it_rests() const override { return "it rests where its leg ends"; }
  std::string greeting_advice() const override {
    return "switch its supply on; thermorig ports finds its baud rate and its ID (new ones have 1000000 and "
           "1)";
  }
};

}  // namespace

std::unique_ptr<ServoDriver> make_sts3215_driver(const ServoProfile& servo) {
  return std::make_unique<Sts3215Driver>(servo);
}

}  // namespace thermorig::rig
