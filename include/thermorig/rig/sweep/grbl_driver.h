// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "thermorig/core/profile.h"
#include "thermorig/core/time.h"
#include "thermorig/rig/sweep/servo_driver.h"

namespace thermorig::rig {

/// Drives a stepper behind GRBL 1.1 by short jogs, of which as few wait as keep it turning: GRBL has no
/// watchdog, so the jogs that it has are all that it turns when the host dies.
class GrblDriver final : public ServoDriver {
 public:
  explicit GrblDriver(const ServoProfile& servo);

  void greet() override;
  void arm(double angle_deg) override;
  void disarm() override;
  void halt() override;
  void run(const wire::RunCommand& command) override;
  void go_to(const wire::GoToCommand& command) override;
  void stop() override;
  void clear() override;
  std::vector<std::uint8_t> poll(HostTime now) override;
  void answer(const wire::ServoMessage& message, HostTime arrived) override;
  void telemetry(const TimedServo& servo) override;

  bool idle() const override;
  bool armed() const override { return armed_; }
  bool gave_up() const override { return gave_up_; }
  bool was_reset() const override { return false; }  // that ends a recording: answer()
  std::optional<std::uint8_t> refusal() const override {
    return {};
  }  // it refuses nothing that can be mended
  HostTime last_ack() const override { return last_ack_; }
  const std::optional<wire::ServoWelcome>& welcome() const override { return welcome_; }
  std::uint64_t retries() const override { return retries_; }

 private:
  /// Where the shaft is to go, piece by piece.
  struct Course {
    double rate_dps = 0.0;  // not negative
    double direction = 1.0;
    double target_deg = 0.0;  // where it ends
    std::uint16_t leg = 0;
    bool turns_back = false;
    HostTime ends{};  // of a leg
    bool is_leg = false;
  };
  /// What is asked of the board before the rig is ready, in this order.
  enum class Setup : std::uint8_t { reset, settings, unlock, position, done };

  std::vector<std::uint8_t> set_up(HostTime now);
  std::vector<std::uint8_t> drive(HostTime now);
  std::vector<std::uint8_t> next_piece(HostTime now);
  void begin(const Course& course);
  void end_leg_in_time(HostTime now);
  void turn_back();
  double estimated_deg(HostTime now) const;
  double limit_deg() const;
  void take_line(const std::string& line, std::uint8_t error, HostTime arrived);
  void take_setting(const std::string& line);
  void check_settings() const;

  ServoProfile servo_;
  Setup setup_ = Setup::reset;
  std::optional<wire::ServoWelcome> greeting_;  // before all else is known
  std::optional<wire::ServoWelcome> welcome_;   // once it is
  double max_rate_dps_ = 0.0, acceleration_dps2_ = 0.0;
  bool is_locked_ = false;
  int tries_ = 0;
  std::optional<HostTime> last_asked_;  // of what set_up() asked last
  bool awaits_ok_ = false;
  HostTime last_line_{};

  std::optional<TimedServo> servo_now_;
  std::optional<Course> course_, next_;  // `next_` waits for rest
  double queued_deg_ = 0.0;              // where the jogs end that were sent
  bool cancel_due_ = false, cancelling_ = false;
  std::optional<bool> power_due_;   // armed or not, which is noted at rest
  std::optional<bool> power_sent_;  // of them, until it is acknowledged
  HostTime cancelled_{};
  HostTime last_status_{};
  bool armed_ = false, gave_up_ = false;
  bool was_set_up_ = false;  // its position counts from then on
  HostTime last_ack_{};
  std::uint64_t retries_ = 0;
};

}  // namespace thermorig::rig
