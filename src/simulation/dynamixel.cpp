// SPDX-License-Identifier: MIT
// A simulated Dynamixel of the X series. Written from protocols/dynamixel.md with an own reading of packets,
// so that an error of the program's does not hide behind the same error here.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include "position_servo.h"
#include "random.h"
#include "stepped_firmware.h"

namespace thermorig::simulation {
namespace {

constexpr std::size_t table_bytes = 147;
constexpr std::size_t most_pending = 1000;
constexpr double degree_a_count = 360.0 / 4096.0;
constexpr double dps_a_unit = 1.374, dps2_a_unit = 21.4577;
constexpr double top_dps = 618.0;  // of an XL330-M288 at 5 V
constexpr std::uint16_t dynamixel_model = 1060, dynamixel_firmware = 45;

enum Address : std::uint16_t {
  id_address = 7,
  return_delay_address = 9,
  drive_mode_address = 10,
  mode_address = 11,
  velocity_limit_address = 44,
  torque_address = 64,
  eeprom_end = 64,
  watchdog_address = 98,
  acceleration_address = 108,
  velocity_address = 112,
  goal_address = 116,
  tick_address = 120,
  moving_address = 122,
  present_velocity_address = 128,
  position_address = 132,
  velocity_trajectory_address = 136,
  position_trajectory_address = 140
};
struct PacketError {
  enum : std::uint8_t { instruction = 2, crc = 3, range = 4, length = 5, limit = 6, access = 7 };
};

/// As Robotis' table does it, from the other end than a bit by bit division: 256 remainders.
const std::array<std::uint16_t, 256>& remainders() {
  static const std::array<std::uint16_t, 256> table = [] {
    std::array<std::uint16_t, 256> made{};
    for (std::size_t i = 1; i < 256; ++i) {
      std::uint32_t rest = static_cast<std::uint32_t>(i) << 16U;
      for (unsigned bit = 24; bit-- > 16;)
        if ((rest >> bit & 1U) != 0) rest ^= 0x18005U << (bit - 16U);
      made[i] = static_cast<std::uint16_t>(rest);
    }
    return made;
  }();
  return table;
}

std::uint16_t check_sum(const std::vector<std::uint8_t>& bytes, std::size_t count) {
  std::uint32_t sum = 0;
  for (std::size_t i = 0; i < count; ++i)
    sum = (sum << 8U ^ remainders()[(sum >> 8U ^ bytes[i]) & 0xFFU]) & 0xFFFFU;
  return static_cast<std::uint16_t>(sum);
}

class Dynamixel final : public SteppedFirmware {
 public:
  Dynamixel(std::uint8_t id, std::uint32_t baud, std::uint64_t seed, const DynamixelHabits& habits,
            const ServoWorld& world)
      : SteppedFirmware(baud),
        habits_(habits),
        random_(seed, "dynamixel"),
        servo_(world, seed, random_.uniform(-60.0, 60.0), top_dps),
        error_phase_rad_(random_.uniform(0.0, 2.0 * std::numbers::pi)),
        first_tick_ms_(static_cast<std::int64_t>(random_.uniform(0.0, 32768.0))) {
    table_[0] = dynamixel_model & 0xFFU;
    table_[1] = dynamixel_model >> 8U;
    table_[6] = dynamixel_firmware;
    table_[id_address] = id;
    table_[return_delay_address] = habits.return_delay;
    table_[mode_address] = habits.operating_mode;
    put(velocity_limit_address, 4, 445);
    begin_at(angle_deg());
    refresh();
  }

  std::string description() const override { return "a simulated Dynamixel"; }

 private:
  // ---- packets ----

  void take(const UartByte& byte) override {
    if (habits_.echoes) transmit(std::array{byte.value}, static_cast<double>(byte.time_us));
    packet_.push_back(byte.value);
    while (!packet_.empty() && !can_begin()) packet_.erase(packet_.begin());
    if (packet_.size() < 7) return;
    const std::size_t whole = 7U + packet_[5] + 256U * packet_[6];
    if (whole > most_pending) return packet_.clear();
    if (packet_.size() < whole) return;
    act(std::exchange(packet_, {}), byte.time_us);
  }

  bool can_begin() const {
    constexpr std::array<std::uint8_t, 4> begin{0xFF, 0xFF, 0xFD, 0x00};
    const std::size_t seen = std::min(packet_.size(), begin.size());
    return std::equal(begin.begin(), begin.begin() + static_cast<std::ptrdiff_t>(seen), packet_.begin());
  }

  /// Anything that is sound on the bus keeps its watchdog quiet.
  void act(std::vector<std::uint8_t> whole, std::int64_t time_us) {
    const bool is_mine = whole[4] == table_[id_address], is_all = whole[4] == 0xFE;
    const std::size_t end = whole.size() - 2;
    if (check_sum(whole, end) != (whole[end] | whole[end + 1] << 8)) {
      if (is_mine) answer(PacketError::crc, {}, time_us);
      return;
    }
    last_heard_us_ = time_us;
    if (!is_mine && !is_all) return;
    std::vector<std::uint8_t> parameters;
    for (std::size_t i = 8; i < end; ++i) {
      parameters.push_back(whole[i]);
      const bool is_stuffed = i >= 9 && whole[i - 2] == 0xFF && whole[i - 1] == 0xFF && whole[i] == 0xFD;
      if (is_stuffed) ++i;
    }
    if (whole[7] == 1) return answer(0, {table_[0], table_[1], table_[6]}, time_us);
    if (parameters.size() < 2) return is_mine ? answer(PacketError::length, {}, time_us) : void();
    const std::size_t address = parameters[0] | parameters[1] << 8;
    if (whole[7] == 2 && is_mine) return read(address, parameters, time_us);
    if (whole[7] == 3) {
      const std::uint8_t error = write(address, {parameters.begin() + 2, parameters.end()});
      if (is_mine) answer(error, {}, time_us);
      return;
    }
    if (is_mine) answer(PacketError::instruction, {}, time_us);
  }

  void read(std::size_t address, const std::vector<std::uint8_t>& parameters, std::int64_t time_us) {
    if (parameters.size() != 4) return answer(PacketError::length, {}, time_us);
    const std::size_t count = parameters[2] | parameters[3] << 8;
    if (address + count > table_bytes) return answer(PacketError::range, {}, time_us);
    refresh();
    put(tick_address, 2, (time_us / 1000 + first_tick_ms_) % 32768);
    answer(0,
           {table_.begin() + static_cast<std::ptrdiff_t>(address),
            table_.begin() + static_cast<std::ptrdiff_t>(address + count)},
           time_us);
  }

  std::uint8_t write(std::size_t address, const std::vector<std::uint8_t>& data) {
    if (data.empty() || address + data.size() > table_bytes) return PacketError::range;
    if (address < eeprom_end && table_[torque_address] != 0) return PacketError::access;
    const bool touches_goals = address < tick_address && address + data.size() > 100;
    if (touches_goals && address != watchdog_address && table_[watchdog_address] == 0xFF)
      return PacketError::limit;
    if (address + data.size() > tick_address) return PacketError::access;
    const auto before = table_;
    std::copy(data.begin(), data.end(), table_.begin() + static_cast<std::ptrdiff_t>(address));
    if (get(velocity_address) > get(velocity_limit_address)) {
      table_ = before;
      return PacketError::limit;
    }
    if (table_[torque_address] != 0 && before[torque_address] == 0) servo_.begin_here();
    return 0;
  }

  /// Stuffed where three bytes in a row would look like a header.
  void answer(std::uint8_t error, const std::vector<std::uint8_t>& parameters, std::int64_t time_us) {
    std::vector<std::uint8_t> content{0x55, error};
    for (const std::uint8_t byte : parameters) {
      content.push_back(byte);
      const std::size_t n = content.size();
      if (byte == 0xFD && content[n - 2] == 0xFF && content[n - 3] == 0xFF) content.push_back(0xFD);
    }
    const std::size_t length = content.size() + 2;
    std::vector<std::uint8_t> whole{0xFF,
                                    0xFF,
                                    0xFD,
                                    0x00,
                                    table_[id_address],
                                    static_cast<std::uint8_t>(length & 0xFFU),
                                    static_cast<std::uint8_t>(length >> 8U)};
    whole.insert(whole.end(), content.begin(), content.end());
    const std::uint16_t sum = check_sum(whole, whole.size());
    whole.push_back(static_cast<std::uint8_t>(sum & 0xFFU));
    whole.push_back(static_cast<std::uint8_t>(sum >> 8U));
    transmit(whole, static_cast<double>(time_us) + 2.0 * table_[return_delay_address]);
  }

  // ---- table ----

  std::int64_t get(std::size_t address) const {
    std::uint32_t number = 0;
    for (std::size_t i = 4; i-- > 0;) number = number << 8U | table_[address + i];
    return static_cast<std::int32_t>(number);
  }
  void put(std::size_t address, std::size_t bytes, std::int64_t value) {
    for (std::size_t i = 0; i < bytes; ++i)
      table_[address + i] = static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * i) & 0xFFU);
  }
  static std::int64_t in_counts(double angle_deg) {
    return std::llround(std::floor(angle_deg / degree_a_count + 0.5)) + 2048;
  }

  /// The magnet's sensor is off by a wave a turn, and counts 4096 of them.
  void refresh() {
    const double turn_rad = angle_deg() * std::numbers::pi / 180.0;
    const double seen_deg = angle_deg() + habits_.encoder_error_deg * std::sin(turn_rad + error_phase_rad_);
    put(position_address, 4, in_counts(seen_deg));
    put(present_velocity_address, 4, std::llround(rate_dps() / dps_a_unit));
    const bool is_on = table_[torque_address] != 0;
    put(velocity_trajectory_address, 4, is_on ? std::llround(servo_.profile_dps() / dps_a_unit) : 0);
    put(position_trajectory_address, 4, in_counts(is_on ? servo_.profile_deg() : seen_deg));
    table_[moving_address] = servo_.profile_dps() != 0.0 ? 1 : 0;
  }

  // ---- motion ----

  bool is_driven() const {
    return table_[torque_address] != 0 && table_[mode_address] == 4 && table_[watchdog_address] != 0xFF;
  }

  double angle_deg() const override { return servo_.shaft_deg(); }
  double rate_dps() const override { return servo_.shaft_dps(); }

  void step(std::int64_t now_us) override {
    const double dt_s = 1e-6 * step_us;
    watch_bus(now_us);
    if (table_[torque_address] == 0) return servo_.coast(dt_s);
    PositionServo::Profile profile{
        .goal_deg = {},
        .most_dps = static_cast<double>(get(velocity_address)) * dps_a_unit,
        .acceleration_dps2 =
            std::max<double>(1.0, static_cast<double>(get(acceleration_address))) * dps2_a_unit};
    if (is_driven()) profile.goal_deg = (static_cast<double>(get(goal_address)) - 2048.0) * degree_a_count;
    servo_.turn(profile, dt_s);
  }

  void watch_bus(std::int64_t now_us) {
    const std::int64_t limit_us = 20'000LL * table_[watchdog_address];
    if (!habits_.has_watchdog || limit_us == 0 || table_[watchdog_address] == 0xFF) return;
    if (now_us - last_heard_us_ > limit_us) table_[watchdog_address] = 0xFF;
  }

  DynamixelHabits habits_;
  Random random_;
  PositionServo servo_;
  double error_phase_rad_;
  std::int64_t first_tick_ms_;
  std::array<std::uint8_t, table_bytes> table_{};
  std::vector<std::uint8_t> packet_;
  std::int64_t last_heard_us_ = 0;
};

}  // namespace

std::unique_ptr<Firmware> make_dynamixel(std::uint8_t id, std::uint32_t baud, std::uint64_t seed,
                                         const DynamixelHabits& habits, const ServoWorld& world) {
  return std::make_unique<Dynamixel>(id, baud, seed, habits, world);
}

}  // namespace thermorig::simulation
