// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "thermorig/pipeline/timing/read_ledger.h"
#include "thermorig/rig/sweep/servo_driver.h"

namespace thermorig::rig {

/// Where the servos of a maker have what, and in which units.
struct BusRegisters {
  std::uint8_t every_id = 0;  // to which all of them listen
  std::uint16_t torque = 0;
  std::uint16_t hardware_error = 0;  // one byte: why it has switched its motor off
  std::uint16_t profile = 0;         // acceleration, speed and goal stand here in one block
  std::uint16_t goal = 0;
  std::size_t goal_bytes = 0;
  std::uint16_t position = 0;
  std::size_t position_answer = 0;  // bytes that are read there; the first goal_bytes are the position
  std::uint16_t telemetry = 0;
  std::size_t telemetry_bytes = 0;
  double reach_deg = 0.0;     // so near to its goal it is there
  double speed_dps = 0.0;     // the least that can be asked for
  double farthest_deg = 0.0;  // either way, where no cable says less
};

/// Drives a servo on a bus in the mode in which it turns to a goal by a profile of speed of its own: the goal
/// is where a leg ends, so that it comes to rest there whatever becomes of the host. One instruction is under
/// way at a time. How its packets look, and what else is between it and a leg, the makers' classes say.
class BusServoDriver : public ServoDriver {
 public:
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
  std::optional<HostDuration> telemetry(const TimedServo& servo) override;
  bool idle() const override { return steps_.empty(); }
  std::uint64_t requests() const override { return requests_; }

 protected:
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

  BusServoDriver(const ServoProfile& servo, const BusRegisters& registers);

  // ---- what differs ----
  virtual Data write_bytes(std::uint8_t id, std::uint16_t address, const Data& data) const = 0;
  virtual Data read_bytes(std::uint16_t address, std::size_t bytes) const = 0;
  virtual Data leg_note(std::uint16_t leg) const = 0;
  /// What it is asked first, whose answer is a ServoWelcome; or all, so that another ID is found.
  virtual Data greeting(bool to_all) const = 0;
  /// Of BusRegisters::profile.
  virtual Data profile_block(double goal_deg, double rate_dps, double acceleration_dps2) const = 0;
  /// It has answered the greeting. Throws Error if it cannot be driven.
  virtual void welcomed() {}
  /// Pushes what it is asked before anything is written to it.
  virtual void look_first() {}
  /// Pushes what it is asked and set to between the greeting and the first command.
  virtual void set_up() = 0;
  /// Pushes the step that has a watchdog watch, if it has one.
  virtual void watch(bool /*is_watching*/) {}
  virtual unsigned watchdog_ms() const { return 0; }
  /// Whether an answer with this error counts. Throws Error, or calls refused().
  virtual bool accepts(std::uint8_t error) = 0;
  /// "overload, overheating"; empty: nothing is wrong.
  virtual std::string hardware_text(std::uint8_t bits) const = 0;
  virtual std::string name() const = 0;
  virtual std::string greeting_advice() const = 0;

  // ---- what they build with ----
  std::uint8_t id() const { return id_; }
  using BitNames = std::initializer_list<std::pair<std::uint8_t, const char*>>;
  static std::string names_of_bits(std::uint8_t bits, BitNames names);
  Step writing(std::string what, std::uint16_t address, Data data) const;
  void push(Step step) { steps_.push_back(std::move(step)); }
  void read(std::string what, std::uint16_t address, std::size_t bytes,
            std::function<void(const Data&)> answer);
  /// Done before all that waits, behind the step that is answered now.
  void insert_next(const std::vector<Step>& steps) {
    steps_.insert(steps_.begin() + 1, steps.begin(), steps.end());
  }
  /// It did not take the step that is under way. `advice`: what to try.
  void refused(const std::string& why, const std::string& advice);
  [[noreturn]] void motor_is_off(const std::string& why) const;

 private:
  /// A leg that is being driven.
  struct Course {
    wire::RunCommand run;
    double direction = 1.0;
    HostTime ends{};
  };

  void then(std::function<void()> done);
  /// Its first step: clear() takes commands whole.
  void command(std::size_t first_step) { steps_[first_step].begins_command = true; }
  Data goal_bytes(double goal_deg, double rate_dps, double acceleration_dps2, std::uint16_t leg) const;
  Data course_bytes();
  double course_goal_deg() const;
  Data next_bytes(HostTime now);
  Data send_step(HostTime now);
  void turn_back();
  void answered(const Data& data, HostTime arrived);
  void look_why_off();
  void take(const wire::ServoWelcome& welcome, HostTime arrived);
  [[noreturn]] void give_up(const Step& step);

  BusRegisters registers_;
  std::uint8_t id_;
  std::deque<Step> steps_;
  std::optional<int> other_id_;  // of a servo that answered in its place
  std::optional<TimedServo> servo_now_;
  std::optional<Course> course_;
  bool stopping_ = false, stop_due_ = false;
  HostTime now_{};
  HostTime armed_at_{};
  HostTime last_read_{};
  timing::ReadLedger reads_;    // of telemetry
  std::uint64_t requests_ = 0;  // of telemetry
};

}  // namespace thermorig::rig
