// SPDX-License-Identifier: MIT
#include "thermorig/rig/sweep/dynamixel_driver.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "servo_link.h"
#include "thermorig/core/error.h"
#include "thermorig/rig/sweep/plan.h"
#include "thermorig/sensors/wire/dynamixel.h"

namespace thermorig::rig {

namespace {

namespace dynamixel = wire::dynamixel;
namespace at = wire::dynamixel::at;

constexpr auto answer_patience = std::chrono::milliseconds(80);
constexpr auto ping_patience = std::chrono::milliseconds(250);  // one that was switched on boots meanwhile
constexpr auto read_period = std::chrono::milliseconds(20);
constexpr int tries = 6, ping_tries = 40;
constexpr std::uint8_t watchdog_20ms = 10;       // 200 ms: a busy host speaks in time, a dead one not
constexpr double command_age_s = 0.04;           // of telemetry by which a goal is chosen, until it is heard
constexpr double one_turn_short_deg = 92'000.0;  // of the 256 turns either way that a goal may have
constexpr std::uint8_t crc_error = 3;
constexpr std::uint8_t error_mask = 0x7F;

std::vector<std::uint8_t> one_byte(std::uint8_t value) {
  return {value};
}

std::string error_text(std::uint8_t error) {
  constexpr std::array<const char*, 8> texts{
      "no error",           "it could not do it", "unknown instruction", "damaged",
      "value out of range", "wrong length",       "beyond limit",        "not now"};
  return error < texts.size() ? texts[error] : fmt::format("error {}", error);
}

/// "overload, overheating".
std::string hardware_text(std::uint8_t bits) {
  constexpr std::array<std::pair<std::uint8_t, const char*>, 5> names{{{0x01, "input voltage"},
                                                                       {0x04, "overheating"},
                                                                       {0x08, "encoder"},
                                                                       {0x10, "electrical shock"},
                                                                       {0x20, "overload"}}};
  std::string text;
  for (const auto& [bit, name] : names)
    if ((bits & bit) != 0) text += (text.empty() ? "" : ", ") + std::string(name);
  return text;
}

std::int32_t counts(double angle_deg) {
  return static_cast<std::int32_t>(std::lround(angle_deg / dynamixel::position_deg)) +
         dynamixel::middle_position;
}

/// At least one unit: 0 would be as fast as it can.
std::int32_t units(double value, double unit) {
  return std::max<std::int32_t>(1, static_cast<std::int32_t>(std::lround(std::abs(value) / unit)));
}

}  // namespace

DynamixelDriver::DynamixelDriver(const ServoProfile& servo)
    : servo_(servo), id_(static_cast<std::uint8_t>(servo.bus_id)) {}

// ---- steps ----------------------------------------------------------------------------------------------

void DynamixelDriver::push(Step step) {
  steps_.push_back(std::move(step));
}

DynamixelDriver::Step DynamixelDriver::writing(std::string what, std::uint16_t address, Data data) const {
  return {
      .what = std::move(what),
      .bytes = [id = id_, address, data = std::move(data)] { return dynamixel::write(id, address, data); },
      .answer = {}};
}

void DynamixelDriver::read(std::string what, std::uint16_t address, std::uint16_t bytes,
                           std::function<void(const Data&)> answer) {
  push({.what = std::move(what),
        .bytes = [id = id_, address, bytes] { return dynamixel::read(id, address, bytes); },
        .answer_bytes = bytes,
        .answer = std::move(answer)});
}

/// What is done when the step that was pushed last has been answered.
void DynamixelDriver::then(std::function<void()> done) {
  steps_.back().answer = [before = std::move(steps_.back().answer),
                          done = std::move(done)](const Data& data) {
    if (before) before(data);
    done();
  };
}

/// Its first step: clear() takes commands whole.
void DynamixelDriver::command(std::size_t first_step) {
  steps_[first_step].begins_command = true;
}

// ---- commands -------------------------------------------------------------------------------------------

void DynamixelDriver::greet() {
  steps_.clear();
  reads_ = false;
  refusal_.reset();
  was_reset_ = gave_up_ = armed_ = false;
  course_.reset();
  welcome_.reset();
  other_id_.reset();
  // To all every other time: a wrong ID in the profile is named.
  push({.what = "a ping",
        .bytes = [this] { return dynamixel::ping(steps_.front().sent % 2 == 0 ? id_ : dynamixel::every_id); },
        .answer = {}});
  disarm();  // an earlier recorder that was killed leaves it armed
  set_up();
}

/// The EEPROM bears so many writes: it is only written where it says otherwise.
void DynamixelDriver::set_up() {
  constexpr std::uint16_t delay_to_mode = 4;  // and one more: an answer of 3 bytes would be a ping's
  const std::size_t first = steps_.size();
  read("its mode", at::return_delay, delay_to_mode, [this](const Data& data) {
    const std::uint8_t drive_mode = data[at::drive_mode - at::return_delay];
    std::vector<Step> changes;
    if (data[0] != 0) changes.push_back(writing("its return delay", at::return_delay, one_byte(0)));
    if ((drive_mode & dynamixel::time_based_profile) != 0)
      changes.push_back(
          writing("its drive mode", at::drive_mode,
                  one_byte(static_cast<std::uint8_t>(drive_mode & ~dynamixel::time_based_profile))));
    if (data[at::operating_mode - at::return_delay] != dynamixel::extended_position_mode)
      changes.push_back(
          writing("its operating mode", at::operating_mode, one_byte(dynamixel::extended_position_mode)));
    steps_.insert(steps_.begin() + 1, changes.begin(), changes.end());
  });
  read("its velocity limit", at::velocity_limit, 4, [this](const Data& data) {
    welcome_->limit_rate_dps = dynamixel::i32_at(data, 0) * dynamixel::velocity_dps;
  });
  command(first);
}

/// The watchdog stands before the torque; the goal is where the shaft is.
void DynamixelDriver::arm(double) {
  const std::size_t first = steps_.size();
  push(writing("its watchdog", at::bus_watchdog, one_byte(0)));  // one that has tripped refuses every goal
  read("its position", at::present_position, 4, [this](const Data& data) {
    steps_[1].bytes = [this, data] { return dynamixel::write(id_, at::goal_position, data); };
  });
  push({.what = "its goal", .bytes = {}, .answer = {}});
  push(writing("its watchdog", at::bus_watchdog, one_byte(watchdog_20ms)));
  push(writing("its torque", at::torque_enable, one_byte(1)));
  then([this] {
    armed_ = true;
    armed_at_ = now_;
  });
  command(first);
}

void DynamixelDriver::disarm() {
  const std::size_t first = steps_.size();
  push(writing("its torque", at::torque_enable, one_byte(0)));
  then([this] { armed_ = false; });
  push(writing("its watchdog", at::bus_watchdog, one_byte(0)));
  command(first);
}

/// The shortest way to rest: the profile's own ramp from where it is by then.
void DynamixelDriver::halt() {
  const std::size_t first = steps_.size();
  push({.what = "its goal",
        .bytes =
            [this] {
              course_.reset();
              if (!servo_now_) return Data();
              const double rate_dps = servo_now_->state.rate_dps;
              const double age_s = std::max(0.0, to_s(now_ - servo_now_->stamp.time)) + command_age_s / 2.0;
              const double way_deg =
                  rate_dps * age_s + rate_dps * std::abs(rate_dps) / (2.0 * servo_.acceleration_dps2);
              return goal_bytes(servo_now_->state.angle_deg + way_deg,
                                std::max(std::abs(rate_dps), dynamixel::velocity_dps),
                                servo_.acceleration_dps2, 0);
            },
        .answer = {}});
  command(first);
}

void DynamixelDriver::run(const wire::RunCommand& command) {
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

void DynamixelDriver::go_to(const wire::GoToCommand& command) {
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

void DynamixelDriver::stop() {
  clear();
  if (!greeted()) steps_.clear();
  course_.reset();
  stopping_ = true;
  stop_due_ = true;
}

void DynamixelDriver::clear() {
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

DynamixelDriver::Data DynamixelDriver::goal_bytes(double goal_deg, double rate_dps, double acceleration_dps2,
                                                  std::uint16_t leg) const {
  const double limit_deg = angle_limit_deg(servo_).value_or(one_turn_short_deg);
  Data profile_and_goal;
  dynamixel::put_i32(units(acceleration_dps2, dynamixel::acceleration_dps2), profile_and_goal);
  dynamixel::put_i32(units(rate_dps, dynamixel::velocity_dps), profile_and_goal);
  dynamixel::put_i32(counts(std::clamp(goal_deg, -limit_deg, limit_deg)), profile_and_goal);
  Data bytes = dynamixel::note(leg);
  const Data written = dynamixel::write(id_, at::profile_acceleration, profile_and_goal);
  bytes.insert(bytes.end(), written.begin(), written.end());
  return bytes;
}

/// Where the leg ends that is being driven, were there no limits.
double DynamixelDriver::course_goal_deg() const {
  const double left_s = std::max(0.0, to_s(course_->ends - now_));
  return servo_now_->state.angle_deg + course_->direction * std::abs(course_->run.rate_dps) * left_s;
}

DynamixelDriver::Data DynamixelDriver::course_bytes() {
  if (!servo_now_) return {};
  return goal_bytes(course_goal_deg(), course_->run.rate_dps, course_->run.acceleration_dps2,
                    course_->run.leg);
}

/// At a limit its own profile has brought it to rest.
void DynamixelDriver::turn_back() {
  const auto limit_deg = angle_limit_deg(servo_);
  if (!course_ || !course_->run.turn_back || !limit_deg || !steps_.empty() || now_ >= course_->ends) return;
  const ServoState& state = servo_now_->state;
  const bool is_there = state.motion == ServoMotion::holding &&
                        course_->direction * state.angle_deg >= *limit_deg - dynamixel::position_deg;
  if (!is_there) return;
  course_->direction = -course_->direction;
  push({.what = "a leg",
        .bytes = [this] { return course_ ? course_bytes() : Data(); },
        .answer = {},
        .begins_command = true});
}

// ---- bytes ----------------------------------------------------------------------------------------------

std::vector<std::uint8_t> DynamixelDriver::poll(HostTime now) {
  now_ = now;
  if (std::exchange(stop_due_, false)) {
    armed_ = false;
    return dynamixel::write(dynamixel::every_id, at::torque_enable, one_byte(0));
  }
  return next_bytes(now);
}

DynamixelDriver::Data DynamixelDriver::next_bytes(HostTime now) {
  if (reads_ && now - last_read_ < answer_patience) return {};
  if (!steps_.empty()) {
    reads_ = false;
    return send_step(now);
  }
  if (!greeted() || (last_read_ != HostTime{} && now - last_read_ < read_period)) return {};
  reads_ = true;
  last_read_ = now;
  return dynamixel::read(id_, dynamixel::telemetry_begin, dynamixel::telemetry_bytes);
}

DynamixelDriver::Data DynamixelDriver::send_step(HostTime now) {
  Step& step = steps_.front();
  const bool pings = !greeted();
  if (step.sent > 0 && now - step.last_sent < (pings ? HostDuration(ping_patience) : answer_patience))
    return {};
  if (step.sent >= (pings ? ping_tries : tries)) give_up(step);
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

void DynamixelDriver::answer(const wire::ServoMessage& message, HostTime arrived) {
  if (const auto* welcome = std::get_if<wire::ServoWelcome>(&message.body)) return take(*welcome, arrived);
  const auto* reply = std::get_if<wire::ServoReply>(&message.body);
  if (reply == nullptr || steps_.empty() || steps_.front().sent == 0 || !greeted()) return;
  const std::uint8_t error = reply->error & error_mask;
  if (error == crc_error) return;  // it is sent again
  if (error != 0) return refused(error);
  if (reply->data.size() == steps_.front().answer_bytes) answered(reply->data, arrived);
}

void DynamixelDriver::answered(const Data& data, HostTime arrived) {
  last_ack_ = arrived;
  if (const auto take_answer = std::exchange(steps_.front().answer, {})) take_answer(data);
  steps_.pop_front();
}

void DynamixelDriver::take(const wire::ServoWelcome& welcome, HostTime arrived) {
  if (greeted() || steps_.empty() || steps_.front().sent == 0) return;
  if (welcome.board != id_) {
    other_id_ = welcome.board;
    return;
  }
  welcome_ = welcome;
  welcome_->watchdog_ms = 20 * watchdog_20ms;
  answered({}, arrived);
}

/// After its watchdog has tripped it takes no goal, which telemetry may not have said yet.
void DynamixelDriver::refused(std::uint8_t error) {
  const std::string what = steps_.front().what;
  const auto next =
      std::find_if(steps_.begin() + 1, steps_.end(), [](const Step& step) { return step.begins_command; });
  steps_.erase(steps_.begin(), next);
  if (stopping_ || armed_) {
    refusal_ = SERVO_REASON_FAULT;
    return;
  }
  throw Error(ExitCode::bad_usage, fmt::format("the servo refused {}: {}", what, error_text(error)), "servo",
              "compare the servo's section of the rig profile with the servo's limits (its velocity limit, "
              "register 44); no other program may hold its torque");
}

// ---- what it says of itself -----------------------------------------------------------------------------

void DynamixelDriver::telemetry(const TimedServo& servo) {
  reads_ = false;
  servo_now_ = servo;
  const bool is_off = servo.state.motion == ServoMotion::disarmed;
  if (armed_ && is_off && servo.stamp.time > armed_at_ && steps_.empty() && !stopping_) look_why_off();
  turn_back();
}

/// Its torque was switched on and is off: it has switched its motor off, or has been off itself.
void DynamixelDriver::look_why_off() {
  read("its state", at::hardware_error, 1, [this](const Data& data) {
    armed_ = false;
    if (data[0] == 0) {
      was_reset_ = true;
      return;
    }
    throw Error(ExitCode::device_lost,
                fmt::format("the servo has switched its motor off: {}", hardware_text(data[0])), "servo",
                "see that nothing holds the shaft and that its supply is strong enough, switch its supply "
                "off and on, then record again");
  });
  command(steps_.size() - 1);
}

void DynamixelDriver::give_up(const Step& step) {
  gave_up_ = true;
  if (greeted())
    throw Error(ExitCode::device_lost,
                fmt::format("the servo has not answered {} after {} tries; its own watchdog stops it",
                            step.what, step.sent),
                "servo", "check cable and power of the servo, then record again");
  if (other_id_)
    throw Error(ExitCode::device_missing,
                fmt::format("no servo of ID {} answers a ping, but one of ID {}", id_, *other_id_), "servo",
                fmt::format("bus_id = {} in [servo] of the rig profile", *other_id_));
  throw Error(ExitCode::device_missing,
              fmt::format("no Dynamixel of ID {} answers a ping at {} baud", id_, servo_.link.baud), "servo",
              "switch its supply on; thermorig ports finds its baud rate and its ID (new ones have 57600 and "
              "1); it must speak protocol 2.0");
}

}  // namespace thermorig::rig
