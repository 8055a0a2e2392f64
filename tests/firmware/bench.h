// SPDX-License-Identifier: MIT
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "servo_link.h"
#include "thermorig/simulation/firmware.h"

namespace thermorig::firmware_test {

using Bytes = std::vector<std::uint8_t>;

struct Message {
  std::uint8_t type = 0, sequence = 0;
  Bytes payload;
  std::int64_t time_us = 0;  // start of its last byte
};

Bytes frame(std::uint8_t type, std::uint8_t sequence, const Bytes& payload);
Bytes payload_of(const servo_configure& message);
Bytes payload_of(const servo_arm& message);
Bytes payload_of(const servo_run& message);
Bytes payload_of(const servo_go_to& message);
Bytes payload_of(const servo_ping& message);

/// The winch of the default rig with the firmware's own limits: 6 turns, 300 deg/s, 20000 deg/s^2.
servo_configure winch();
servo_configure continuous();

/// A host without pity for one firmware: sends bytes at exact times and keeps all that comes back.
class Bench {
 public:
  /// Waits for the first telemetry, as a host does: a firmware that starts up hears nothing.
  explicit Bench(std::unique_ptr<simulation::Firmware> firmware);

  /// Bytes on the line from now on, 40 us each; time passes.
  void send(const Bytes& bytes);
  void run_for(std::int64_t duration_us);
  /// The same with a REFRESH every 40 ms.
  void run_refreshed(std::int64_t duration_us);

  /// Sends a command with the next sequence number, waits for its answer and returns that.
  Message command(std::uint8_t type, const Bytes& payload = {});
  /// Whatever answers these bytes within 20 ms: WELCOME, ACK, NACK or PONG.
  std::optional<Message> answer_to(const Bytes& bytes);
  /// HELLO of our version; then the sequence starts at 1.
  Message hello(std::uint8_t version = SERVO_LINK_VERSION);
  void open(const servo_configure& configuration, std::int32_t angle_cdeg = 0);

  const std::vector<servo_telemetry>& telemetry() const { return telemetry_; }
  const std::vector<Message>& telemetry_frames() const { return telemetry_frames_; }
  const std::vector<servo_event>& events() const { return events_; }
  const std::vector<simulation::PulseEdge>& pulses() const { return pulses_; }
  const std::vector<servo_shaft>& shaft() const { return shaft_; }
  const std::vector<simulation::RegisterWrite>& writes() const { return writes_; }
  /// An AS5600 on the I2C shows this from now on.
  void sense(const simulation::SensorRegisters& registers) { firmware_->sense(registers); }
  servo_telemetry now() const { return telemetry_.empty() ? servo_telemetry{} : telemetry_.back(); }
  std::int64_t now_us() const { return now_us_; }
  std::uint8_t next_sequence = 1;
  int damaged = 0;  // frames from the servo

 private:
  void advance(std::int64_t until_us);
  void take(const Message& message);

  std::unique_ptr<simulation::Firmware> firmware_;
  servo_decoder decoder_{};
  std::int64_t now_us_ = 0;
  std::vector<Message> answers_, telemetry_frames_;
  std::vector<servo_telemetry> telemetry_;
  std::vector<servo_event> events_;
  std::vector<simulation::PulseEdge> pulses_;
  std::vector<servo_shaft> shaft_;
  std::vector<simulation::RegisterWrite> writes_;
};

/// Reason of a NACK, 0 for any other answer.
int reason(const Message& answer);
int reason(const std::optional<Message>& answer);
int count(const Bench& bench, servo_event_kind kind, int detail);

enum class Form { host_build, avr_image };

/// Both forms of the firmware; the AVR image is skipped where it or simavr is missing.
class FirmwareTest : public testing::TestWithParam<Form> {
 protected:
  void SetUp() override;
  Bench& bench() { return *bench_; }
  /// A fresh reset.
  void restart();
  bool is_avr() const { return GetParam() == Form::avr_image; }

 private:
  std::unique_ptr<Bench> bench_;
};

}  // namespace thermorig::firmware_test
