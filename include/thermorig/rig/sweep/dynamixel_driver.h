// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "thermorig/core/profile.h"
#include "thermorig/core/time.h"
#include "thermorig/rig/sweep/servo_driver.h"

namespace thermorig::rig {

/// Drives a Dynamixel of the X series in extended position mode with a profile of speed: its goal is where a
/// leg ends, so that it comes to rest there whatever becomes of the host, and its bus watchdog stops it
/// before that where nobody speaks on the bus. One instruction is under way at a time.
class DynamixelDriver final : public ServoDriver {
 public:
  explicit DynamixelDriver(const ServoProfile& servo);

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

  bool idle() const override { return steps_.empty(); }
  bool armed() const override { return armed_; }
  bool gave_up() const override { return gave_up_; }
  bool was_reset() const override { return was_reset_; }
  std::optional<std::uint8_t> refusal() const override { return refusal_; }
  HostTime last_ack() const override { return last_ack_; }
  const std::optional<wire::ServoWelcome>& welcome() const override { return welcome_; }
  std::uint64_t retries() const override { return retries_; }

 private:
  using Data = std::vector<std::uint8_t>;
  /// One instruction and what becomes of its answer.
  struct Step {
    std::string what;                         // "the goal", for errors
    std::function<Data()> bytes;              // made when it is sent; empty: there is nothing to do any more
    std::size_t answer_bytes = 0;             // of the answer's parameters
    std::function<void(const Data&)> answer;  // may be none
    bool begins_command = false;
    int sent = 0;
    HostTime last_sent{};
  };
  /// A leg that is being driven.
  struct Course {
    wire::RunCommand run;
    double direction = 1.0;
    HostTime ends{};
  };

  Step writing(std::string what, std::uint16_t address, Data data) const;
  void read(std::string what, std::uint16_t address, std::uint16_t bytes,
            std::function<void(const Data&)> answer);
  void push(Step step);
  void command(std::size_t first_step);
  void set_up();
  void then(std::function<void()> done);
  Data goal_bytes(double goal_deg, double rate_dps, double acceleration_dps2, std::uint16_t leg) const;
  Data course_bytes();
  double course_goal_deg() const;
  Data next_bytes(HostTime now);
  Data send_step(HostTime now);
  void turn_back();
  void answered(const Data& data, HostTime arrived);
  void refused(std::uint8_t error);
  void look_why_off();
  void take(const wire::ServoWelcome& welcome, HostTime arrived);
  [[noreturn]] void give_up(const Step& step);

  ServoProfile servo_;
  std::uint8_t id_;
  std::deque<Step> steps_;
  std::optional<wire::ServoWelcome> welcome_;
  std::optional<int> other_id_;  // of a servo that answered in its place
  std::optional<TimedServo> servo_now_;
  std::optional<Course> course_;
  bool armed_ = false, stopping_ = false, stop_due_ = false, was_reset_ = false, gave_up_ = false;
  std::optional<std::uint8_t> refusal_;
  HostTime now_{};
  HostTime armed_at_{};
  HostTime last_ack_{};
  HostTime last_read_{};
  bool reads_ = false;  // telemetry is under way
  std::uint64_t retries_ = 0;
};

}  // namespace thermorig::rig
