// SPDX-License-Identifier: MIT
#include "thermorig/rig/sweep/servo_commander.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <utility>

#include "servo_link.h"
#include "thermorig/core/error.h"

namespace thermorig::rig {

namespace {

constexpr std::size_t pings_remembered = 8;
constexpr int configure_tries_max = 200;  // one a poll: far longer than any stop takes
constexpr std::uint16_t short_ping_delay_us = 3000;
// A latency timer holds answers back for up to 16 ms: the delay must be longer than that to average it out.
constexpr std::uint16_t long_ping_delay_us = SERVO_PING_DELAY_MAX_US;
constexpr double latency_timer_s = 0.006;  // more than USB frames and the wire take together

void append(std::vector<std::uint8_t>& out, const std::vector<std::uint8_t>& bytes) {
  out.insert(out.end(), bytes.begin(), bytes.end());
}

// Irregular, so that no periodic delay of the link hides; the same in every run. Knuth's multiplicative hash.
HostDuration ping_gap(HostDuration mean, std::uint32_t token) {
  const std::uint32_t hash = token * 2654435761U;
  const std::int64_t per_mille = 700 + static_cast<std::int64_t>((hash >> 16U) % 601U);
  return mean * per_mille / 1000;
}

bool can_be_mended(std::uint8_t reason) {
  return reason == SERVO_REASON_FAULT || reason == SERVO_REASON_NOT_ARMED;
}

bool guards_cable(const ServoProfile& servo) {
  return servo.kind == ServoKind::continuous && servo.travel_deg > 0.0;
}

/// Since 1.2.0 the angle limits hold for continuous servos too.
bool guards_cables(const std::string& firmware) {
  unsigned major = 0, minor = 0;
  return std::sscanf(firmware.c_str(), "%u.%u", &major, &minor) == 2 && (major > 1 || minor >= 2);
}

bool has_forgotten_us(std::uint8_t reason) {
  return reason == SERVO_REASON_WRONG_VERSION || reason == SERVO_REASON_OUT_OF_SEQUENCE ||
         reason == SERVO_REASON_NOT_CONFIGURED;
}

}  // namespace

ServoCommander::ServoCommander(const ServoProfile& servo, const CommanderTimes& times)
    : ServoDriver(servo), times_(times) {}

void ServoCommander::push(std::uint8_t type, std::function<std::vector<std::uint8_t>(std::uint8_t)> bytes) {
  queue_.push_back({.type = type, .bytes = std::move(bytes)});
}

void ServoCommander::greet() {
  queue_.clear();  // hello starts the numbers anew, so nothing needs to be waited for
  forget();
  configure_tries_ = 0;
  push(SERVO_HELLO, wire::asking_hello_bytes);
  disarm();  // an earlier recorder that was killed leaves it armed
  push(SERVO_CONFIGURE,
       [servo = servo_](std::uint8_t sequence) { return wire::configure_bytes(sequence, servo); });
}

void ServoCommander::arm(double angle_deg) {
  push(SERVO_ARM, [angle_deg](std::uint8_t sequence) { return wire::arm_bytes(sequence, angle_deg); });
}

void ServoCommander::disarm() {
  push(SERVO_DISARM, wire::disarm_bytes);
}

void ServoCommander::halt() {
  push(SERVO_HALT, wire::halt_bytes);
}

void ServoCommander::run(const wire::RunCommand& command) {
  push(SERVO_RUN, [command](std::uint8_t sequence) { return wire::run_bytes(sequence, command); });
}

void ServoCommander::go_to(const wire::GoToCommand& command) {
  push(SERVO_GO_TO, [command](std::uint8_t sequence) { return wire::go_to_bytes(sequence, command); });
}

void ServoCommander::stop() {
  clear();
  if (!greeted()) queue_.clear();
  stopping_ = true;
  stop_byte_due_ = true;
}

void ServoCommander::clear() {
  // A command in flight keeps its place until it is answered: whether the servo took it is not known, and the
  // next number depends on that.
  std::erase_if(queue_, [](const Command& command) { return command.sent == 0; });
  refusal_.reset();
}

std::vector<std::uint8_t> ServoCommander::poll(HostTime now) {
  std::vector<std::uint8_t> out;
  if (std::exchange(stop_byte_due_, false)) append(out, wire::stop_bytes());
  send_command(now, out);
  send_refresh(now, out);
  send_ping(now, out);
  if (!out.empty()) last_bytes_ = now;
  return out;
}

void ServoCommander::send_command(HostTime now, std::vector<std::uint8_t>& out) {
  if (queue_.empty()) return;
  Command& command = queue_.front();
  const bool hello = command.type == SERVO_HELLO;
  const HostDuration patience = hello ? times_.hello_answer : times_.answer;
  if (command.sent > 0 && now - command.last_sent < patience) return;
  if (command.sent >= (hello ? times_.hello_tries : times_.tries)) give_up(command);
  if (command.sent == 0)
    command.sequence = next_sequence_++;
  else
    ++retries_;
  append(out, command.bytes(command.sequence));
  ++command.sent;
  command.last_sent = now;
}

void ServoCommander::send_refresh(HostTime now, std::vector<std::uint8_t>& out) {
  if (armed_ && out.empty() && now - last_bytes_ >= times_.refresh) append(out, wire::refresh_bytes());
}

void ServoCommander::send_ping(HostTime now, std::vector<std::uint8_t>& out) {
  if (!greeted() || now < next_ping_) return;
  const std::uint32_t token = ++ping_token_;
  append(out, wire::ping_bytes(token, latency_timer_ ? long_ping_delay_us : short_ping_delay_us));
  pings_.push_back({token, now});
  if (pings_.size() > pings_remembered) pings_.pop_front();
  next_ping_ = now + ping_gap(times_.ping, token);
}

std::optional<HostDuration> ServoCommander::pong(const TimedPong& pong) {
  const auto same = [&](const SentPing& ping) { return ping.token == pong.token; };
  const auto ping = std::find_if(pings_.begin(), pings_.end(), same);
  if (ping == pings_.end()) return std::nullopt;
  const double held_s = 1e-6 * (pong.send_us - pong.receive_us);
  const double under_way_s = to_s(pong.arrival - ping->time) - held_s;
  if (under_way_s > latency_timer_s) latency_timer_ = true;
  pings_.erase(ping);
  return from_s(under_way_s);
}

void ServoCommander::answer(const wire::ServoMessage& message, HostTime arrived) {
  if (const auto* welcome = std::get_if<wire::ServoWelcome>(&message.body))
    take(*welcome, message.sequence, arrived);
  else if (const auto* ack = std::get_if<wire::ServoAck>(&message.body)) {
    if (is_answer_to_front(ack->type, message.sequence)) acknowledged(arrived);
  } else if (const auto* nack = std::get_if<wire::ServoNack>(&message.body))
    take(*nack, message.sequence);
  else if (const auto* event = std::get_if<wire::ServoEvent>(&message.body))
    take(*event);
}

bool ServoCommander::is_answer_to_front(std::uint8_t type, std::uint8_t sequence) const {
  return !queue_.empty() && queue_.front().sent > 0 && queue_.front().type == type &&
         queue_.front().sequence == sequence;
}

void ServoCommander::acknowledged(HostTime arrived) {
  const std::uint8_t type = queue_.front().type;
  if (type == SERVO_ARM) armed_ = true;
  if (type == SERVO_DISARM) armed_ = false;
  last_ack_ = arrived;
  queue_.pop_front();
}

void ServoCommander::take(const wire::ServoWelcome& welcome, std::uint8_t sequence, HostTime arrived) {
  if (!is_answer_to_front(SERVO_HELLO, sequence)) return;
  if (welcome.version != SERVO_LINK_VERSION) wrong_version(welcome.version);
  if (guards_cable(servo_) && !guards_cables(welcome.firmware))
    throw Error(ExitCode::device_missing,
                fmt::format("the servo's firmware {} does not guard the cable of a continuous servo",
                            welcome.firmware),
                "servo",
                "reflash the servo board with this program's firmware (firmware_servo), or state in the rig "
                "profile that there is no cable to wind up: travel_deg = 0");
  welcome_ = welcome;
  acknowledged(arrived);
}

void ServoCommander::take(const wire::ServoNack& nack, std::uint8_t sequence) {
  if (!is_answer_to_front(nack.type, sequence)) return;
  if (nack.type == SERVO_HELLO && nack.reason == SERVO_REASON_WRONG_VERSION) wrong_version(nack.detail);
  if (nack.type == SERVO_CONFIGURE && nack.reason == SERVO_REASON_ARMED &&
      configure_tries_ < configure_tries_max) {
    ++configure_tries_;  // still coming to rest after the disarm before it: once more, as a new command
    queue_.front().sent = 0;
    return;
  }
  queue_.pop_front();
  if (stopping_ || can_be_mended(nack.reason)) {
    refusal_ = nack.reason;
  } else if (has_forgotten_us(nack.reason)) {
    was_reset_ = true;
  } else if (nack.type == SERVO_ARM && nack.reason == SERVO_REASON_BEYOND_LIMIT && guards_cable(servo_)) {
    throw Error(ExitCode::device_missing,
                fmt::format("the cable of the continuous servo is wound up beyond the {:.0f} degrees of its "
                            "travel, and firmware {} does not unwind it",
                            servo_.travel_deg, welcome_ ? welcome_->firmware : "before 1.2.1"),
                "servo",
                "untwist the cable by hand, then switch the supply of the servo's board off and on; firmware "
                "1.2.1 and later unwinds by itself (firmware_servo)");
  } else {
    throw Error(ExitCode::bad_usage,
                fmt::format("the servo refused \"{}\": {}", wire::command_name(nack.type),
                            wire::reason_text(nack.reason)),
                "servo", "compare the servo's section of the rig profile with the limits of its firmware");
  }
}

void ServoCommander::take(const wire::ServoEvent& event) {
  if (event.kind == SERVO_EVENT_RESET && greeted()) was_reset_ = true;
}

void ServoCommander::give_up(const Command& command) {
  gave_up_ = true;
  if (command.type == SERVO_HELLO)
    throw Error(ExitCode::device_missing, "the servo does not answer hello", "servo",
                "check that its board carries the servo firmware and that the port is the right one: "
                "thermorig ports");
  throw Error(ExitCode::device_lost,
              fmt::format("the servo has not answered \"{}\" after {} tries; {}",
                          wire::command_name(command.type), command.sent, how_it_rests()),
              "servo", "check cable and power of the servo's board, then record again");
}

void ServoCommander::wrong_version(unsigned firmware) const {
  throw Error(ExitCode::device_missing,
              fmt::format("the servo's firmware speaks version {} of the servo link, this program version {}",
                          firmware, SERVO_LINK_VERSION),
              "servo", "reflash the servo board with this program's firmware (firmware_servo)");
}

}  // namespace thermorig::rig
