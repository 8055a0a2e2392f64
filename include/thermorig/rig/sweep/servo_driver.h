// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "thermorig/core/profile.h"
#include "thermorig/core/sample.h"
#include "thermorig/core/time.h"
#include "thermorig/sensors/wire/servo_messages.h"

namespace thermorig::rig {

/// Drives a servo by its protocol. Pure: the caller brings the time, carries the bytes and feeds the answers.
/// Whatever the protocol, a servo whose host falls silent comes to rest by itself within half a second, or at
/// the end of its leg.
class ServoDriver {
 public:
  virtual ~ServoDriver() = default;

  // Commands wait in a queue; each is sent when the one before was acknowledged.
  virtual void greet() = 0;  // who it is, disarm, set up; forgets everything queued
  virtual void arm(double angle_deg) = 0;
  virtual void disarm() = 0;
  virtual void halt() = 0;
  virtual void run(const wire::RunCommand& command) = 0;
  virtual void go_to(const wire::GoToCommand& command) = 0;

  /// Stops it ahead of everything; forgets the queue. From here on refusals are only noted.
  virtual void stop() = 0;

  /// Forgets what is queued; a command that was sent already is still brought to its end.
  virtual void clear() = 0;

  /// Bytes to write now; empty if there is nothing to say. Call every 10 ms or so. Throws Error:
  /// device_missing if the greeting is never answered, device_lost if a later command is not.
  virtual std::vector<std::uint8_t> poll(HostTime now) = 0;

  /// An answer of the servo. Throws Error: device_missing for one that cannot be driven, bad_usage for a
  /// command that it refuses for its values.
  virtual void answer(const wire::ServoMessage& message, HostTime arrived) = 0;

  /// What it said of its motion. Throws as answer() does. Returns how long request and answer were under way;
  /// none if it was not asked.
  virtual std::optional<HostDuration> telemetry(const TimedServo&) { return std::nullopt; }

  /// An answer to a ping. Returns how long it was under way, without what the firmware held it back; none if
  /// it is not ours.
  virtual std::optional<HostDuration> pong(const TimedPong&) { return std::nullopt; }

  virtual bool idle() const = 0;  // everything was acknowledged
  bool armed() const { return armed_; }
  bool gave_up() const { return gave_up_; }                         // a command was never answered
  bool was_reset() const { return was_reset_; }                     // it must be greeted again
  std::optional<std::uint8_t> refusal() const { return refusal_; }  // enum servo_reason: fault or not armed
  HostTime last_ack() const { return last_ack_; }
  const std::optional<wire::ServoWelcome>& welcome() const { return welcome_; }
  std::uint64_t retries() const { return retries_; }
  virtual std::uint64_t requests() const { return 0; }  // sent, whose answers pong() or telemetry() takes

  bool greeted() const { return welcome_.has_value(); }
  /// What becomes of it where nobody reaches it any more: "its own watchdog stops it".
  virtual std::string how_it_rests() const = 0;

 protected:
  explicit ServoDriver(const ServoProfile& servo) : servo_(servo) {}
  ServoDriver(const ServoDriver&) = default;
  ServoDriver& operator=(const ServoDriver&) = default;

  /// What was known of it is no longer: it is greeted.
  void forget() {
    refusal_.reset();
    welcome_.reset();
    was_reset_ = gave_up_ = armed_ = false;
  }

  ServoProfile servo_;
  std::optional<wire::ServoWelcome> welcome_;
  std::optional<std::uint8_t> refusal_;
  bool armed_ = false, was_reset_ = false, gave_up_ = false;
  HostTime last_ack_{};
  std::uint64_t retries_ = 0;
};

/// The driver of the profile's protocol.
std::unique_ptr<ServoDriver> make_servo_driver(const ServoProfile& servo);

}  // namespace thermorig::rig
