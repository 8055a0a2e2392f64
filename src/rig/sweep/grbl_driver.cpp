// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "thermorig/core/error.h"
#include "thermorig/rig/sweep/plan.h"
#include "thermorig/rig/sweep/servo_driver.h"
#include "thermorig/sensors/wire/grbl.h"

namespace thermorig::rig {

namespace {

namespace grbl = wire::grbl;

constexpr double piece_s = 0.2;   // of a jog; two of them are under way at most: 0.4 s
constexpr double ahead_s = 0.22;  // the next one is sent when so much is left
constexpr auto status_period = std::chrono::milliseconds(100);
constexpr auto status_patience = std::chrono::milliseconds(130);  // a report that was lost leaves no gap
constexpr auto boot_patience = std::chrono::milliseconds(2500);   // opening the port has reset it
constexpr auto line_patience = std::chrono::milliseconds(500);
constexpr int reset_tries = 5, line_tries = 6;
constexpr double same_acceleration = 0.05;
constexpr double angle_step_deg = 0.002;  // nearer than that is there

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
  std::optional<HostDuration> telemetry(const TimedServo& servo) override;

  std::string how_it_rests() const override { return "it rests where its last jog ends"; }
  bool idle() const override;
  std::uint64_t requests() const override { return requests_; }

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
  std::uint8_t ask_status(HostTime now);
  void begin(const Course& course);
  void end_leg_in_time(HostTime now);
  void turn_back();
  double estimated_deg(HostTime now) const;
  double limit_deg() const;
  void take_line(const std::string& line, std::uint8_t error, HostTime arrived);
  void take_setting(const std::string& line);
  void check_settings() const;

  Setup setup_ = Setup::reset;
  std::optional<wire::ServoWelcome> greeting_;  // welcome_, before all else is known
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
  std::optional<HostTime> awaits_status_;  // since then
  std::uint64_t requests_ = 0;             // of its status
  bool was_set_up_ = false;                // its position counts from then on
};

GrblDriver::GrblDriver(const ServoProfile& servo) : ServoDriver(servo) {}

double GrblDriver::limit_deg() const {
  return angle_limit_deg(servo_).value_or(std::numeric_limits<double>::infinity());
}

bool GrblDriver::idle() const {
  return setup_ == Setup::done && !next_ && !cancel_due_ && !cancelling_ && !power_due_;
}

// ---- commands -------------------------------------------------------------------------------------------

/// Opening its port resets most boards, which then greet; others are reset by a byte.
void GrblDriver::greet() {
  const bool was_set_up = was_set_up_ || setup_ == Setup::done;
  const std::uint64_t requests = requests_;
  *this = GrblDriver(servo_);
  was_set_up_ = was_set_up;
  requests_ = requests;
}

void GrblDriver::arm(double) {
  power_due_ = true;
}

void GrblDriver::disarm() {
  halt();
  power_due_ = false;
}

void GrblDriver::halt() {
  course_.reset();
  next_.reset();
  cancel_due_ = true;
}

/// From rest: what moves is brought there first.
void GrblDriver::begin(const Course& course) {
  halt();
  next_ = course;
}

void GrblDriver::run(const wire::RunCommand& command) {
  Course course{.rate_dps = std::abs(command.rate_dps),
                .direction = sign_of(command.rate_dps),
                .leg = command.leg,
                .turns_back = command.turn_back,
                .ends = last_status_ + from_s(command.duration_s),
                .is_leg = true};
  course.target_deg = course.direction * limit_deg();
  const bool goes_on = course_ && course_->is_leg && course_->leg == command.leg;
  if (goes_on)
    course_->ends = course.ends;
  else
    begin(course);
}

void GrblDriver::go_to(const wire::GoToCommand& command) {
  const double target_deg = std::clamp(command.angle_deg, -limit_deg(), limit_deg());
  begin({.rate_dps = command.rate_dps, .target_deg = target_deg});
}

void GrblDriver::stop() {
  clear();
  halt();
}

void GrblDriver::clear() {
  next_.reset();
  power_due_ = power_sent_;
}

// ---- time -----------------------------------------------------------------------------------------------

std::vector<std::uint8_t> GrblDriver::poll(HostTime now) {
  if (setup_ != Setup::done && !cancel_due_) return set_up(now);
  if (std::exchange(cancel_due_, false)) {
    cancelling_ = true;
    cancelled_ = now;
    return {grbl::jog_cancel, ask_status(now)};
  }
  std::vector<std::uint8_t> bytes = drive(now);
  if (now - last_status_ >= (awaits_status_ ? status_patience : status_period))
    bytes.insert(bytes.begin(), ask_status(now));
  return bytes;
}

std::uint8_t GrblDriver::ask_status(HostTime now) {
  last_status_ = now;
  if (!awaits_status_) awaits_status_ = now;
  ++requests_;
  return grbl::status_request;
}

std::vector<std::uint8_t> GrblDriver::set_up(HostTime now) {
  const bool resets = setup_ == Setup::reset;
  const HostDuration patience = resets ? HostDuration(boot_patience) : HostDuration(line_patience);
  if (!last_asked_ && resets) last_asked_ = now;  // it may be booting
  if (last_asked_ && now - *last_asked_ < patience) return {};
  if (tries_ >= (resets ? reset_tries : line_tries)) {
    gave_up_ = true;
    throw Error(
        ExitCode::device_missing, "no GRBL answers on this port", "servo",
        "check that the board carries GRBL 1.1, its baud rate (115200) and the port: thermorig ports");
  }
  if (tries_ > 0) ++retries_;
  ++tries_;
  last_asked_ = now;
  switch (setup_) {
    case Setup::reset:
      return {grbl::soft_reset};
    case Setup::settings:
      return grbl::settings_request();
    case Setup::unlock:
      return grbl::unlock();
    case Setup::position:
      return {ask_status(now)};
    case Setup::done:
      break;
  }
  return {};
}

/// By the last report, which is up to 0.1 s old.
double GrblDriver::estimated_deg(HostTime now) const {
  const ServoState& state = servo_now_->state;
  return state.angle_deg + state.rate_dps * to_s(now - servo_now_->stamp.time);
}

std::vector<std::uint8_t> GrblDriver::drive(HostTime now) {
  if (awaits_ok_ && !cancelling_ && now - last_line_ > line_patience) {
    gave_up_ = true;
    throw Error(ExitCode::device_lost, "GRBL has not answered a line; " + how_it_rests(), "servo",
                "check cable and power of its board, then record again");
  }
  if (awaits_ok_ || cancelling_ || !servo_now_) return {};
  if (power_due_) {
    power_sent_ = power_due_;
    awaits_ok_ = true;
    last_line_ = now;
    return grbl::power_note(*power_due_);
  }
  if (!course_) return {};
  if (course_->is_leg && now >= course_->ends) return {};
  return next_piece(now);
}

std::vector<std::uint8_t> GrblDriver::next_piece(HostTime now) {
  const double left_deg = course_->is_leg ? course_->direction * (course_->target_deg - queued_deg_)
                                          : std::abs(course_->target_deg - queued_deg_);
  if (left_deg < angle_step_deg || course_->rate_dps <= 0.0) return {};
  if (!course_->is_leg) course_->direction = sign_of(course_->target_deg - queued_deg_);
  const double ahead_deg = course_->direction * (queued_deg_ - estimated_deg(now));
  if (ahead_deg > ahead_s * course_->rate_dps) return {};
  const double way_deg = std::min(left_deg, piece_s * course_->rate_dps);
  const double target_deg =
      std::round((queued_deg_ + course_->direction * way_deg) / grbl::position_unit_deg) *
      grbl::position_unit_deg;
  const double signed_deg = target_deg - queued_deg_;
  queued_deg_ = target_deg;
  awaits_ok_ = true;
  last_line_ = now;
  return grbl::jog_line({signed_deg, course_->rate_dps, course_->leg});
}

/// At the end of the travel the last piece has brought it to rest.
void GrblDriver::turn_back() {
  if (!course_ || !course_->is_leg || !course_->turns_back || awaits_ok_) return;
  const ServoState& state = servo_now_->state;
  if (!is_at_rest(state) || std::abs(state.angle_deg - course_->target_deg) > angle_step_deg) return;
  course_->direction = -course_->direction;
  course_->target_deg = -course_->target_deg;
}

// ---- answers --------------------------------------------------------------------------------------------

std::optional<HostDuration> GrblDriver::telemetry(const TimedServo& servo) {
  servo_now_ = servo;
  const bool rests = is_at_rest(servo.state) && servo.stamp.arrival > cancelled_;
  if (setup_ == Setup::position) {
    setup_ = Setup::done;
    welcome_ = greeting_;
    queued_deg_ = servo.state.angle_deg;
    last_ack_ = servo.stamp.arrival;
  }
  if (cancelling_ && rests) {
    cancelling_ = awaits_ok_ = false;
    queued_deg_ = servo.state.angle_deg;
    last_ack_ = servo.stamp.arrival;
    course_ = std::exchange(next_, {});
  }
  turn_back();
  const auto asked = std::exchange(awaits_status_, {});
  return asked ? std::optional(servo.stamp.arrival - *asked) : std::nullopt;
}

void GrblDriver::answer(const wire::ServoMessage& message, HostTime arrived) {
  if (const auto* welcome = std::get_if<wire::ServoWelcome>(&message.body)) {
    if (setup_ == Setup::done || was_set_up_)
      throw Error(ExitCode::device_lost, "the GRBL board was reset, and does not know where its shaft is",
                  "servo",
                  "turn the cable to its middle, then record again; a board that resets by itself "
                  "lacks power");
    greeting_ = *welcome;
    setup_ = Setup::settings;
    is_locked_ = false;
    tries_ = 0;
    last_asked_.reset();
    return;
  }
  if (const auto* reply = std::get_if<wire::ServoReply>(&message.body))
    take_line({reply->data.begin(), reply->data.end()}, reply->error, arrived);
}

void GrblDriver::take_line(const std::string& line, std::uint8_t error, HostTime arrived) {
  if (line.starts_with("$")) return take_setting(line);
  if (line.starts_with("[")) {
    is_locked_ = is_locked_ || line.find("to unlock") != line.npos;
    return;
  }
  if (error != 0 && !cancelling_ && !cancel_due_)
    throw Error(line.starts_with("ALARM") ? ExitCode::device_lost : ExitCode::bad_usage,
                fmt::format("GRBL says \"{}\"", line), "servo",
                "its limits: $20 (soft limits) and $21 (hard limits) must be 0 for an axis that turns; "
                "protocols/grbl.md");
  awaits_ok_ = false;
  last_ack_ = arrived;
  if (const auto noted = std::exchange(power_sent_, {})) {
    armed_ = *noted;
    if (power_due_ == noted) power_due_.reset();
  }
  if (setup_ == Setup::settings) {
    check_settings();
    greeting_->limit_rate_dps = max_rate_dps_;
    setup_ = is_locked_ ? Setup::unlock : Setup::position;
  } else if (setup_ == Setup::unlock) {
    setup_ = Setup::position;
  } else {
    return;
  }
  tries_ = 0;
  last_asked_.reset();
}

void GrblDriver::take_setting(const std::string& line) {
  const auto setting = grbl::parse_setting(line);
  if (!setting) return;
  if (setting->number == grbl::rate_setting) max_rate_dps_ = setting->value / 60.0;
  if (setting->number == grbl::acceleration_setting) acceleration_dps2_ = setting->value;
}

void GrblDriver::check_settings() const {
  const double wanted_dps2 = servo_.acceleration_dps2;
  if (std::abs(acceleration_dps2_ - wanted_dps2) <= same_acceleration * wanted_dps2) return;
  throw Error(ExitCode::device_missing,
              fmt::format("the board accelerates by {:.0f} deg/s^2, the rig profile says {:.0f}",
                          acceleration_dps2_, wanted_dps2),
              "servo",
              fmt::format("$120={:.0f} on the board, or acceleration_dps2 = {:.0f} in [servo] of the "
                          "rig profile",
                          wanted_dps2, acceleration_dps2_));
}

}  // namespace

std::unique_ptr<ServoDriver> make_grbl_driver(const ServoProfile& servo) {
  return std::make_unique<GrblDriver>(servo);
}

}  // namespace thermorig::rig
