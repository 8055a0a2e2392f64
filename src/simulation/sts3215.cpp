// SPDX-License-Identifier: MIT
// A simulated Feetech STS3215. Written from protocols/sts3215.md with an own reading of packets, so that an
// error of the program's does not hide behind the same error here.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

#include "position_servo.h"
#include "random.h"
#include "stepped_firmware.h"

namespace thermorig::simulation {
namespace {

constexpr std::size_t memory_bytes = 71;
constexpr double counts_a_degree = 4096.0 / 360.0;
constexpr double sts_top_dps = 276.0;  // one that was measured at 12 V: TheRobotStudio/SO-ARM100, issue 134
constexpr double dead_band_counts = 2.0;
constexpr int counts_of_a_turn = 4096;

enum Cell : std::uint8_t {
  id_cell = 5,
  delay_cell = 7,
  answers_cell = 8,
  least_cell = 9,
  most_cell = 11,
  phase_cell = 18,
  mode_cell = 33,
  first_of_ram = 40,
  torque_cell = 40,
  acceleration_cell = 41,
  goal_cell = 42,
  speed_cell = 46,
  lock_cell = 55,
  position_cell = 56,
  present_speed_cell = 58,
  voltage_cell = 62,
  status_cell = 65,
  moving_cell = 66
};

class Sts3215 final : public SteppedFirmware {
 public:
  Sts3215(std::uint8_t id, std::uint32_t baud, std::uint64_t seed, const Sts3215Habits& habits,
          const ServoWorld& world)
      : SteppedFirmware(baud),
        habits_(habits),
        random_(seed, "sts3215"),
        servo_(worn(world, habits), seed, random_.uniform(-60.0, 60.0), sts_top_dps),
        error_phase_rad_(random_.uniform(0.0, 2.0 * std::numbers::pi)) {
    memory_[0] = 3;
    memory_[1] = 10;
    memory_[3] = habits.model;
    memory_[4] = 3;
    memory_[id_cell] = id;
    memory_[delay_cell] = habits.return_delay;
    memory_[answers_cell] = habits.answers_writes ? 1 : 0;
    if (habits.counts_turns)
      memory_[phase_cell] = 0x10;
    else
      store(most_cell, 4095);
    memory_[lock_cell] = 1;
    memory_[voltage_cell] = 74;
    memory_[status_cell] = habits.complains ? 1 : 0;
    begin_at(angle_deg());
    look();
  }

  std::string description() const override { return "a simulated STS3215"; }

 private:
  static ServoWorld worn(ServoWorld world, const Sts3215Habits& habits) {
    world.backlash_deg = std::max(world.backlash_deg, habits.play_deg);
    world.ripple = std::max(world.ripple, habits.unevenness / 2.0);
    return world;
  }

  // ---- packets: FF FF, ID, length, instruction, parameters, sum ----

  void take(const UartByte& byte) override {
    if (habits_.echoes) transmit(std::array{byte.value}, static_cast<double>(byte.time_us));
    const std::size_t place = packet_.size();
    if (place < 2 ? byte.value != 0xFF : place == 2 && byte.value == 0xFF) {
      packet_.resize(std::min<std::size_t>(place, byte.value == 0xFF ? 2 : 0));
      return;
    }
    packet_.push_back(byte.value);
    if (packet_.size() < 4 || packet_.size() < packet_[3] + 4U) return;
    const std::vector<std::uint8_t> whole = std::exchange(packet_, {});
    if (whole[3] >= 2) obey(whole, byte.time_us);
  }

  void obey(const std::vector<std::uint8_t>& whole, std::int64_t time_us) {
    const int sum = std::accumulate(whole.begin() + 2, whole.end(), 0);  // its own check sum makes it FF
    const bool is_mine = whole[2] == memory_[id_cell], is_all = whole[2] == 0xFE;
    if ((sum & 0xFF) != 0xFF || (!is_mine && !is_all)) return;
    const std::vector<std::uint8_t> parameters(whole.begin() + 5, whole.end() - 1);
    if (whole[4] == 1) return answer({}, time_us);
    if (whole[4] == 2 && is_mine && parameters.size() == 2) {
      if (parameters[0] + parameters[1] > static_cast<int>(memory_bytes)) return;
      look();
      const auto first = memory_.begin() + parameters[0];
      return answer({first, first + parameters[1]}, time_us);
    }
    if (whole[4] != 3 || parameters.size() < 2) return;
    store_block(parameters[0], {parameters.begin() + 1, parameters.end()});
    if (is_mine && memory_[answers_cell] != 0) answer({}, time_us);
  }

  /// What cannot be written is passed over in silence.
  void store_block(std::size_t address, const std::vector<std::uint8_t>& data) {
    const bool was_off = memory_[torque_cell] == 0;
    for (std::size_t i = 0; i < data.size(); ++i) {
      const std::size_t cell = address + i;
      const bool is_locked = cell < first_of_ram && memory_[lock_cell] != 0;
      if (cell >= id_cell && cell < position_cell && !is_locked) memory_[cell] = data[i];
    }
    const bool sets_goal = address <= goal_cell && address + data.size() > goal_cell;
    if (sets_goal) {
      memory_[torque_cell] = 1;  // a goal switches its torque on
      goal_counts_ = load(goal_cell);
      if (const int most = load(most_cell); most > 0)
        goal_counts_ = std::clamp(goal_counts_, load(least_cell), most);
    }
    if (was_off && memory_[torque_cell] != 0) {
      servo_.begin_here();
      if (!sets_goal) goal_counts_ = load(position_cell);
    }
  }

  void answer(std::vector<std::uint8_t> parameters, std::int64_t time_us) {
    std::vector<std::uint8_t> whole{0xFF, 0xFF, memory_[id_cell],
                                    static_cast<std::uint8_t>(parameters.size() + 2), memory_[status_cell]};
    whole.insert(whole.end(), parameters.begin(), parameters.end());
    const int sum = std::accumulate(whole.begin() + 2, whole.end(), 0);
    whole.push_back(static_cast<std::uint8_t>(0xFF - (sum & 0xFF)));
    transmit(whole, static_cast<double>(time_us) + 2.0 * memory_[delay_cell] + 20.0);
  }

  // ---- memory ----

  /// Fifteen bits and a sign.
  int load(std::size_t cell) const {
    const int size = memory_[cell] + 256 * (memory_[cell + 1] % 128);
    return memory_[cell + 1] >= 128 ? -size : size;
  }
  void store(std::size_t cell, int value) {
    memory_[cell] = static_cast<std::uint8_t>(std::abs(value) % 256);
    memory_[cell + 1] = static_cast<std::uint8_t>(std::abs(value) / 256 + (value < 0 ? 128 : 0));
  }

  bool counts_turns() const {
    return load(least_cell) == 0 && load(most_cell) == 0 && (memory_[phase_cell] & 0x10) != 0;
  }

  void look() {
    const double wave_deg =
        habits_.encoder_error_deg * std::sin(angle_deg() * std::numbers::pi / 180.0 + error_phase_rad_);
    int counts = static_cast<int>(std::lround((angle_deg() + wave_deg) * counts_a_degree)) + 2048;
    if (!counts_turns()) counts = ((counts % counts_of_a_turn) + counts_of_a_turn) % counts_of_a_turn;
    store(position_cell, counts);
    store(present_speed_cell, static_cast<int>(std::lround(rate_dps() * counts_a_degree)));
    const bool arrives = std::abs(static_cast<double>(goal_counts_ - counts)) <= dead_band_counts &&
                         servo_.profile_dps() == 0.0;
    memory_[moving_cell] = memory_[torque_cell] != 0 && !arrives ? 1 : 0;
  }

  // ---- motion ----

  double angle_deg() const override { return servo_.shaft_deg(); }
  double rate_dps() const override { return servo_.shaft_dps(); }

  void step(std::int64_t) override {
    constexpr double dt_s = 1e-6 * step_us;
    if (memory_[torque_cell] == 0) return servo_.coast(dt_s);
    const int asked = std::abs(load(speed_cell)), acceleration = memory_[acceleration_cell];
    servo_.turn(
        {.goal_deg = (goal_counts_ - 2048) / counts_a_degree,
         .most_dps = asked > 0 ? asked / counts_a_degree : sts_top_dps,
         .acceleration_dps2 = (acceleration > 0 ? 100.0 * acceleration : 100'000.0) / counts_a_degree},
        dt_s);
  }

  Sts3215Habits habits_;
  Random random_;
  PositionServo servo_;
  double error_phase_rad_;
  std::array<std::uint8_t, memory_bytes> memory_{};
  std::vector<std::uint8_t> packet_;
  int goal_counts_ = 0;
};

}  // namespace

std::unique_ptr<Firmware> make_sts3215(std::uint8_t id, std::uint32_t baud, std::uint64_t seed,
                                       const Sts3215Habits& habits, const ServoWorld& world) {
  return std::make_unique<Sts3215>(id, baud, seed, habits, world);
}

}  // namespace thermorig::simulation
