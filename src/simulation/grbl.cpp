// SPDX-License-Identifier: MIT
// A simulated stepper behind GRBL 1.1, from protocols/grbl.md: its lines, its real-time bytes, its trapezia.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <deque>
#include <string>
#include <utility>
#include <vector>

#include "position_servo.h"
#include "random.h"
#include "stepped_firmware.h"

namespace thermorig::simulation {
namespace {

constexpr std::int64_t boot_us = 1'600'000;  // a boot loader listens first
constexpr std::size_t longest_line = 80;
constexpr std::size_t planned_max = 15;
constexpr double steps_a_degree = 3200.0 * 4.0 / 360.0;  // of motor and gear
constexpr unsigned offsets_every = 30, overrides_every = 20;

class Grbl final : public SteppedFirmware {
 public:
  Grbl(std::uint32_t baud, std::uint64_t seed, const GrblHabits& habits, const ServoWorld& world)
      : SteppedFirmware(baud),
        habits_(habits),
        stands_at_deg_(Random(seed, "grbl").uniform(-40.0, 40.0)),
        train_(world, seed, motor_deg()) {
    begin_at(angle_deg());
  }

  /// The line that says so resets an Arduino.
  void opened(std::int64_t time_us) override {
    if (!habits_.resets_on_open) return;
    has_booted_ = false;
    reset_us_ = time_us;
    jogs_.clear();
    rate_dps_ = 0.0;
  }

  std::string description() const override { return "a simulated GRBL"; }

 private:
  struct Jog {
    double left_deg;  // signed
    double feed_dps;
  };

  // ---- lines ----

  void take(const UartByte& byte) override {
    now_us_ = byte.time_us;
    if (!has_booted_) return;
    if (byte.value == '?') return report();
    if (byte.value == 0x18) return soft_reset();
    if (byte.value == 0x85) {
      cancels_ = !jogs_.empty();
      return;
    }
    if (byte.value >= 0x80 || byte.value == '!' || byte.value == '~') return;
    if (byte.value == '\n' || byte.value == '\r') return obey(std::exchange(line_, {}));
    if (line_.size() < longest_line) line_.push_back(static_cast<char>(byte.value));
  }

  void say(const std::string& text) {
    const std::string line = text + "\r\n";
    transmit(std::vector<std::uint8_t>(line.begin(), line.end()), static_cast<double>(now_us_));
  }

  /// It keeps its position, but not that of a motor that was turning.
  void soft_reset() {
    if (rate_dps_ != 0.0) is_locked_ = true;
    begin_anew();
  }

  void start() {
    has_booted_ = true;
    is_locked_ = habits_.is_locked;
    stands_at_deg_ = motor_deg();
    position_deg_ = 0.0;
    begin_anew();
  }

  void begin_anew() {
    jogs_.clear();
    rate_dps_ = 0.0;
    line_.clear();
    cancels_ = false;
    say("");
    say("Grbl 1.1h ['$' for help]");
    if (is_locked_) say("[MSG:'$H'|'$X' to unlock]");
  }

  static std::string without_notes(const std::string& line) {
    std::string text;
    bool in_note = false;
    for (const char character : line) {
      if (character == '(') in_note = true;
      if (!in_note && character != ' ') text.push_back(character);
      if (character == ')') in_note = false;
    }
    return text;
  }

  void obey(const std::string& given) {
    const std::string line = without_notes(given);
    if (line == "$$") {
      say("$10=1");
      say(fmt::format("$100={:.3f}", set_steps()));
      say(fmt::format("$110={:.3f}", 60.0 * habits_.max_rate_dps));
      say(fmt::format("$120={:.3f}", habits_.acceleration_dps2));
    }
    if (line == "$X") is_locked_ = false;
    if (line.rfind("$J=", 0) == 0) return jog(line);
    say(line.empty() || line == "$$" || line == "$X" ? "ok" : "error:3");
  }

  void jog(const std::string& line) {
    const std::size_t way = line.find('X'), feed = line.find('F');
    if (is_locked_) return say("error:9");
    if (line.find("G91") == line.npos || way == line.npos || feed == line.npos) return say("error:22");
    if (jogs_.size() >= planned_max) return say("error:60");
    const double feed_dps = std::strtod(line.c_str() + feed + 1, nullptr) / 60.0;
    const double way_deg = std::strtod(line.c_str() + way + 1, nullptr);
    if (!cancels_) jogs_.push_back({way_deg, std::min(feed_dps, habits_.max_rate_dps)});
    say("ok");
  }

  void report() {
    const char* const state = is_locked_ ? "Alarm" : jogs_.empty() ? "Idle" : "Jog";
    const double reported_deg = std::round(position_deg_ * set_steps()) / set_steps();
    std::string text = fmt::format("<{}|MPos:{:.3f},0.000,0.000|FS:{:.0f},0", state, reported_deg,
                                   std::abs(60.0 * rate_dps_));
    ++reports_;
    if (reports_ % offsets_every == 1)
      text += "|WCO:0.000,0.000,0.000";
    else if (reports_ % overrides_every == 2)
      text += "|Ov:100,100,100";
    say(text + ">");
  }

  // ---- motion ----

  double rate_dps() const override { return rate_dps_; }
  double angle_deg() const override { return train_.shaft_deg(); }
  double set_steps() const { return steps_a_degree * (1.0 + habits_.steps_error); }
  double motor_deg() const {
    return stands_at_deg_ + std::round(position_deg_ * 16.0 * set_steps()) / (16.0 * steps_a_degree);
  }

  void step(std::int64_t now_us) override {
    now_us_ = now_us;
    if (!has_booted_ && now_us >= reset_us_ + boot_us) start();
    move(1e-6 * step_us * (1.0 + habits_.clock_error));
    train_.follow(motor_deg());
  }

  /// Jogs of one direction join without a stop; each is planned so that the last of them ends at rest.
  void move(double dt_s) {
    if (jogs_.empty()) return;
    const double direction = std::copysign(1.0, jogs_.front().left_deg);
    double way_deg = 0.0;
    for (const Jog& jog : jogs_) {
      if (std::copysign(1.0, jog.left_deg) != direction) break;
      way_deg += std::abs(jog.left_deg);
    }
    const double change_dps = habits_.acceleration_dps2 * dt_s;
    const double fits_dps = std::sqrt(2.0 * habits_.acceleration_dps2 * way_deg);
    const double wanted_dps = cancels_ ? 0.0 : std::min(jogs_.front().feed_dps, fits_dps);
    double speed_dps = std::abs(rate_dps_);
    speed_dps += std::clamp(wanted_dps - speed_dps, -change_dps, change_dps);
    double moved_deg = std::min(speed_dps * dt_s, way_deg);
    if (way_deg < change_dps * dt_s) moved_deg = way_deg;
    position_deg_ += direction * moved_deg;
    rate_dps_ = direction * speed_dps;
    while (moved_deg > 0.0 && !jogs_.empty()) {
      const double taken_deg = std::min(moved_deg, std::abs(jogs_.front().left_deg));
      moved_deg -= taken_deg;
      jogs_.front().left_deg -= direction * taken_deg;
      if (std::abs(jogs_.front().left_deg) > 1e-9) break;
      jogs_.pop_front();
    }
    if (cancels_ && speed_dps == 0.0) {
      jogs_.clear();
      cancels_ = false;
    }
    if (jogs_.empty()) rate_dps_ = 0.0;
  }

  GrblHabits habits_;
  std::string line_;
  std::deque<Jog> jogs_;
  bool has_booted_ = false, is_locked_ = false, cancels_ = false;
  unsigned reports_ = 0;
  std::int64_t reset_us_ = 0, now_us_ = 0;
  double position_deg_ = 0.0, rate_dps_ = 0.0;
  double stands_at_deg_;  // of the motor, when its position was 0
  GearTrain train_;
};

}  // namespace

std::unique_ptr<Firmware> make_grbl(std::uint32_t baud, std::uint64_t seed, const GrblHabits& habits,
                                    const ServoWorld& world) {
  return std::make_unique<Grbl>(baud, seed, habits, world);
}

}  // namespace thermorig::simulation
