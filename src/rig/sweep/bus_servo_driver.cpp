// SPDX-License-Identifier: MIT
#include "bus_servo_driver.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "servo_link.h"
#include "thermorig/core/error.h"
#include "thermorig/rig/sweep/plan.h"

namespace thermorig::rig {

namespace {

constexpr auto answer_patience = std::chrono::milliseconds(80);
constexpr auto greeting_patience =
    std::chrono::milliseconds(250);  // one that was switched on boots meanwhile
constexpr auto read_period = std::chrono::milliseconds(20);
constexpr int tries = 6, greeting_tries = 40;
constexpr double command_age_s = 0.04;  // of the telemetry that a goal is chosen by, until it is heard

}  // namespace

BusServoDriver::BusServoDriver(const ServoProfile& servo, const BusRegisters& registers)
    : ServoDriver(servo), registers_(registers), id_(static_cast<std::uint8_t>(servo.bus_id)) {}

std::string BusServoDriver::names_of_bits(std::uint8_t bits, BitNames names) {
  std::string text;
  for (const auto& [bit, name] : names)
    if ((bits & bit) != 0) text += (text.empty() ? "" : ", ") + std::string(name);
  return text;
}

// ---- steps ----------------------------------------------------------------------------------------------

BusServoDriver::Step BusServoDriver::writing(std::string what, std::uint16_t address, Data data) const {
  return {.what = std::move(what),
          .bytes = [this, address, data = std::move(data)] { return write_bytes(id_, address, data); },
          .answer = {}};
}

void BusServoDriver::read(std::string what, std::uint16_t address, std::size_t bytes,
                          std::function<void(const Data&)> answer) {
  push({.what = std::move(what),
        .bytes = [this, address, bytes] { return read_bytes(address, bytes); },
        .answer_bytes = bytes,
        .answer = std::move(answer)});
}

/// What is done when the step that was pushed last has been answered.
void BusServoDriver::then(std::function<void()> done) {
  steps_.back().answer = [done = std::move(done)](const Data&) { done(); };
}

// ---- commands -------------------------------------------------------------------------------------------

void BusServoDriver::greet() {
  steps_.clear();
  forget();
  reads_.restart();
  course_.reset();
  other_id_.reset();
  // To all every other time: a wrong ID in the profile is named.
  push({.what = "its greeting",
        .bytes = [this] { return greeting(steps_.front().sent % 2 == 1); },
        .answer = {}});
  look_first();
  disarm();  // an earlier recorder that was killed leaves it armed
  const std::size_t first = steps_.size();
  set_up();
  command(first);
}

/// What stops it stands before the torque; the goal is where the shaft is.
void BusServoDriver::arm(double) {
  const std::size_t first = steps_.size();
  watch(false);  // a watchdog that has tripped refuses every goal
  read("its position", registers_.position, registers_.position_answer, [this](const Data& data) {
    const Data goal(data.begin(), data.begin() + static_cast<std::ptrdiff_t>(registers_.goal_bytes));
    steps_[1].bytes = [this, goal] { return write_bytes(id_, registers_.goal, goal); };
  });
  push({.what = "its goal", .bytes = {}, .answer = {}});
  watch(true);
  push(writing("its torque", registers_.torque, {1}));
  then([this] {
    armed_ = true;
    armed_at_ = now_;
  });
  command(first);
}

void BusServoDriver::disarm() {
  const std::size_t first = steps_.size();
  push(writing("its torque", registers_.torque, {0}));
  then([this] { armed_ = false; });
  watch(false);
  command(first);
}

/// The shortest way to rest: the profile's own ramp from where it is by then.
void BusServoDriver::halt() {
  const std::size_t first = steps_.size();
  push({.what = "its goal",
        .bytes =
            [this] {
              course_.reset();
              if (!armed_ || !servo_now_) return Data();  // a goal may switch the torque on
              const double rate_dps = servo_now_->state.rate_dps;
              const double age_s = std::max(0.0, to_s(now_ - servo_now_->stamp.time)) + command_age_s / 2.0;
              const double way_deg =
                  rate_dps * age_s + rate_dps * std::abs(rate_dps) / (2.0 * servo_.acceleration_dps2);
              return goal_bytes(servo_now_->state.angle_deg + way_deg,
                                std::max(std::abs(rate_dps), registers_.speed_dps), servo_.acceleration_dps2,
                                0);
            },
        .answer = {}});
  command(first);
}

void BusServoDriver::run(const wire::RunCommand& command) {
  const std::size_t first = steps_.size();
  push({.what = "a leg",
        .bytes =
            [this, command] {
              course_ = Course{command, sign_of(command.rate_dps), now_ + from_s(command.duration_s)};
              return course_bytes();
            },
        .answer = {}});
  this->command(first);
}

void BusServoDriver::go_to(const wire::GoToCommand& command) {
  const std::size_t first = steps_.size();
  push({.what = "an angle",
        .bytes =
            [this, command] {
              course_.reset();
              return goal_bytes(command.angle_deg, command.rate_dps, command.acceleration_dps2, 0);
            },
        .answer = {}});
  this->command(first);
}

void BusServoDriver::stop() {
  clear();
  if (!greeted()) steps_.clear();
  course_.reset();
  stopping_ = true;
  stop_due_ = true;
}

void BusServoDriver::clear() {
  if (!steps_.empty() && steps_.front().sent > 0) {  // it is brought to its end
    const auto next =
        std::find_if(steps_.begin() + 1, steps_.end(), [](const Step& step) { return step.begins_command; });
    steps_.erase(next, steps_.end());
  } else {
    steps_.clear();
  }
  refusal_.reset();
}

// ---- goals ----------------------------------------------------------------------------------------------

BusServoDriver::Data BusServoDriver::goal_bytes(double goal_deg, double rate_dps, double acceleration_dps2,
                                                std::uint16_t leg) const {
  const double limit_deg = angle_limit_deg(servo_).value_or(registers_.farthest_deg);
  Data bytes = leg_note(leg);
  const Data written =
      write_bytes(id_, registers_.profile,
                  profile_block(std::clamp(goal_deg, -limit_deg, limit_deg), rate_dps, acceleration_dps2));
  bytes.insert(bytes.end(), written.begin(), written.end());
  return bytes;
}

/// Where the leg ends that is being driven, were there no limits.
double BusServoDriver::course_goal_deg() const {
  const double left_s = std::max(0.0, to_s(course_->ends - now_));
  return servo_now_->state.angle_deg + course_->direction * std::abs(course_->run.rate_dps) * left_s;
}

BusServoDriver::Data BusServoDriver::course_bytes() {
  if (!servo_now_) return {};
  return goal_bytes(course_goal_deg(), course_->run.rate_dps, course_->run.acceleration_dps2,
                    course_->run.leg);
}

/// At a limit its own profile has brought it to rest.
void BusServoDriver::turn_back() {
  const auto limit_deg = angle_limit_deg(servo_);
  if (!course_ || !course_->run.turn_back || !limit_deg || !steps_.empty() || now_ >= course_->ends) return;
  const ServoState& state = servo_now_->state;
  const bool is_there = state.motion == ServoMotion::holding &&
                        course_->direction * state.angle_deg >= *limit_deg - registers_.reach_deg;
  if (!is_there) return;
  course_->direction = -course_->direction;
  push({.what = "a leg",
        .bytes = [this] { return course_ ? course_bytes() : Data(); },
        .answer = {},
        .begins_command = true});
}

// ---- bytes ----------------------------------------------------------------------------------------------

std::vector<std::uint8_t> BusServoDriver::poll(HostTime now) {
  now_ = now;
  if (std::exchange(stop_due_, false)) {
    armed_ = false;
    return write_bytes(registers_.every_id, registers_.torque, {0});
  }
  return next_bytes(now);
}

/// After one that was not answered in time there is a pause after the next one, in which its answer would
/// come: those of later ones are not taken for it.
BusServoDriver::Data BusServoDriver::next_bytes(HostTime now) {
  if (reads_.is_open() && now - last_read_ < answer_patience) return {};
  if (!steps_.empty()) return send_step(now);
  const HostDuration pause =
      reads_.is_unsure() ? timing::ReadLedger::longest_answer + read_period : HostDuration(read_period);
  if (!greeted() || (last_read_ != HostTime{} && now - last_read_ < pause)) return {};
  reads_.asked(now);
  ++requests_;
  last_read_ = now;
  return read_bytes(registers_.telemetry, registers_.telemetry_bytes);
}

BusServoDriver::Data BusServoDriver::send_step(HostTime now) {
  Step& step = steps_.front();
  const bool greets = !greeted();
  if (step.sent > 0 && now - step.last_sent < (greets ? HostDuration(greeting_patience) : answer_patience))
    return {};
  if (step.sent >= (greets ? greeting_tries : tries)) give_up(step);
  if (step.sent > 0) ++retries_;
  Data bytes = step.bytes();
  if (bytes.empty()) {
    steps_.pop_front();
    return {};
  }
  ++step.sent;
  step.last_sent = now;
  return bytes;
}

void BusServoDriver::answer(const wire::ServoMessage& message, HostTime arrived) {
  if (const auto* welcome = std::get_if<wire::ServoWelcome>(&message.body)) return take(*welcome, arrived);
  const auto* reply = std::get_if<wire::ServoReply>(&message.body);
  if (reply == nullptr) return;
  if (reply->id != id_) {
    other_id_ = reply->id;
    return;
  }
  if (!greeted() || !accepts(reply->error) || steps_.empty() || steps_.front().sent == 0) return;
  if (reply->data.size() == steps_.front().answer_bytes) answered(reply->data, arrived);
}

void BusServoDriver::answered(const Data& data, HostTime arrived) {
  last_ack_ = arrived;
  if (const auto take_answer = std::exchange(steps_.front().answer, {})) take_answer(data);
  steps_.pop_front();
}

void BusServoDriver::take(const wire::ServoWelcome& welcome, HostTime arrived) {
  if (greeted() || steps_.empty() || steps_.front().sent == 0) return;
  if (welcome.board != id_) {
    other_id_ = welcome.board;
    return;
  }
  welcome_ = welcome;
  welcome_->watchdog_ms = watchdog_ms();
  welcomed();
  answered({}, arrived);
}

void BusServoDriver::refused(const std::string& why, const std::string& advice) {
  if (steps_.empty() || steps_.front().sent == 0) return;
  const std::string what = steps_.front().what;
  const auto next =
      std::find_if(steps_.begin() + 1, steps_.end(), [](const Step& step) { return step.begins_command; });
  steps_.erase(steps_.begin(), next);
  if (stopping_ || armed_) {
    refusal_ = SERVO_REASON_FAULT;
    return;
  }
  throw Error(ExitCode::bad_usage, fmt::format("the servo refused {}: {}", what, why), "servo", advice);
}

// ---- what it says of itself -----------------------------------------------------------------------------

std::optional<HostDuration> BusServoDriver::telemetry(const TimedServo& servo) {
  const auto request = reads_.answered(servo.stamp.arrival);
  servo_now_ = servo;
  const bool is_off = servo.state.motion == ServoMotion::disarmed;
  if (armed_ && is_off && servo.stamp.time > armed_at_ && steps_.empty() && !stopping_) look_why_off();
  turn_back();
  return request ? std::optional(servo.stamp.arrival - request->asked) : std::nullopt;
}

/// Its torque was switched on and is off: it has switched its motor off, or has been off itself, and has
/// then forgotten how often it had turned.
void BusServoDriver::look_why_off() {
  read("its state", registers_.hardware_error, 1, [this](const Data& data) {
    armed_ = false;
    const std::string why = hardware_text(data[0]);
    if (!why.empty()) motor_is_off(why);
    throw Error(ExitCode::device_lost,
                "the servo's torque went off by itself: its supply may have failed, and it does not know its "
                "turns any more",
                "servo", "check its supply, turn the cable to its middle, then record again");
  });
  command(steps_.size() - 1);
}

void BusServoDriver::motor_is_off(const std::string& why) const {
  throw Error(ExitCode::device_lost, fmt::format("the servo has switched its motor off: {}", why), "servo",
              "see that nothing holds the shaft and that its supply is strong enough, switch its supply "
              "off and on, then record again");
}

void BusServoDriver::give_up(const Step& step) {
  gave_up_ = true;
  if (greeted())
    throw Error(
        ExitCode::device_lost,
        fmt::format("the servo has not answered {} after {} tries; {}", step.what, step.sent, how_it_rests()),
        "servo", "check cable and power of the servo, then record again");
  if (other_id_)
    throw Error(ExitCode::device_missing,
                fmt::format("no servo with ID {} answers, but one with ID {}", id_, *other_id_), "servo",
                fmt::format("set bus_id = {} in [servo] of the rig profile", *other_id_));
  throw Error(ExitCode::device_missing,
              fmt::format("no {} with ID {} answers at {} baud", name(), id_, servo_.link.baud), "servo",
              greeting_advice());
}

}  // namespace thermorig::rig
