// SPDX-License-Identifier: MIT
#include "bench.h"

#include <algorithm>

#include "simulation/simulated_ports/avr_firmware.h"

namespace thermorig::firmware_test {
namespace {

class Payload {
 public:
  Payload& u8(std::uint8_t value) {
    bytes_.push_back(value);
    return *this;
  }
  Payload& u16(std::uint16_t value) {
    return u8(static_cast<std::uint8_t>(value & 0xFFU)).u8(static_cast<std::uint8_t>(value >> 8U));
  }
  Payload& u32(std::uint32_t value) {
    return u16(static_cast<std::uint16_t>(value & 0xFFFFU)).u16(static_cast<std::uint16_t>(value >> 16U));
  }
  Payload& i32(std::int32_t value) { return u32(static_cast<std::uint32_t>(value)); }
  operator Bytes() const { return bytes_; }

 private:
  Bytes bytes_;
};

servo_telemetry telemetry_in(const Bytes& payload) {
  const std::uint8_t* at = payload.data();
  EXPECT_NE(at[14] & SERVO_FINE_TICKS, 0U);
  return {servo_get_u32(at),
          static_cast<std::int32_t>(servo_get_u32(at + 4)),
          static_cast<std::int32_t>(servo_get_u32(at + 8)),
          servo_get_u16(at + 12),
          static_cast<std::uint8_t>(at[14] & ~SERVO_FINE_TICKS),
          at[15],
          servo_get_u16(at + 16)};
}

}  // namespace

Bytes frame(std::uint8_t type, std::uint8_t sequence, const Bytes& payload) {
  std::uint8_t out[2 * 256];
  const std::uint8_t size =
      servo_frame(out, type, sequence, payload.data(), static_cast<std::uint8_t>(payload.size()));
  return {out, out + size};
}

Bytes payload_of(const servo_configure& m) {
  return Payload()
      .u8(m.kind)
      .u16(m.pulse_min_us)
      .u16(m.pulse_max_us)
      .u32(m.span)
      .u32(m.limit_rate_cdps)
      .u16(m.limit_acceleration_dps2)
      .i32(m.angle_min_cdeg)
      .i32(m.angle_max_cdeg);
}
Bytes payload_of(const servo_arm& m) {
  return Payload().i32(m.angle_cdeg);
}
Bytes payload_of(const servo_run& m) {
  return Payload().u16(m.leg).u8(m.flags).i32(m.rate_cdps).u16(m.acceleration_dps2).u32(m.duration_ms);
}
Bytes payload_of(const servo_go_to& m) {
  return Payload().i32(m.angle_cdeg).u32(m.rate_cdps).u16(m.acceleration_dps2);
}
Bytes payload_of(const servo_ping& m) {
  return Payload().u32(m.token).u16(m.delay_max_us);
}

servo_configure winch() {
  return {SERVO_KIND_POSITIONAL, 500, 2500, 216000, 30000, 20000, -107800, 107800};
}
servo_configure continuous() {
  return {SERVO_KIND_CONTINUOUS, 1000, 2000, 60000, 30000, 20000, 0, 0};
}

Bench::Bench(std::unique_ptr<simulation::Firmware> firmware) : firmware_(std::move(firmware)) {
  run_for(15'000);
}

void Bench::send(const Bytes& bytes) {
  for (const std::uint8_t byte : bytes) {
    now_us_ += 40;
    firmware_->receive(byte, now_us_);
  }
  advance(now_us_);
}

void Bench::run_for(std::int64_t duration_us) {
  advance(now_us_ + duration_us);
}

void Bench::run_refreshed(std::int64_t duration_us) {
  const std::int64_t end_us = now_us_ + duration_us;
  while (now_us_ < end_us) {
    send(frame(SERVO_REFRESH, 0, {}));
    advance(std::min(end_us, now_us_ + 39'000));
  }
}

void Bench::advance(std::int64_t until_us) {
  now_us_ = std::max(now_us_, until_us);
  const simulation::FirmwareOutput output = firmware_->run_until(now_us_);
  pulses_.insert(pulses_.end(), output.pulses.begin(), output.pulses.end());
  writes_.insert(writes_.end(), output.writes.begin(), output.writes.end());
  for (const simulation::UartByte& byte : output.bytes) {
    const servo_decoded decoded = servo_decoder_push(&decoder_, byte.value);
    if (decoded == SERVO_DECODED_FRAME)
      take({decoder_.body[0], decoder_.body[1],
            Bytes(decoder_.body + 2, decoder_.body + 2 + servo_decoder_payload_size(&decoder_)),
            byte.time_us});
    else if (decoded != SERVO_DECODED_NOTHING)
      ++damaged;
  }
}

void Bench::take(const Message& message) {
  const std::uint8_t* at = message.payload.data();
  if (message.type == SERVO_TELEMETRY) {
    telemetry_.push_back(telemetry_in(message.payload));
    telemetry_frames_.push_back(message);
  } else if (message.type == SERVO_EVENT) {
    events_.push_back({at[0], servo_get_u16(at + 1), servo_get_u32(at + 3)});
  } else if (message.type == SERVO_SHAFT) {
    shaft_.push_back({servo_get_u32(at), servo_get_u16(at + 4), at[6], at[7]});
  } else {
    answers_.push_back(message);
  }
}

std::optional<Message> Bench::answer_to(const Bytes& bytes) {
  answers_.clear();
  send(bytes);
  for (int i = 0; i < 30 && answers_.empty(); ++i) run_for(1000);
  return answers_.empty() ? std::nullopt : std::optional(answers_.front());
}

Message Bench::command(std::uint8_t type, const Bytes& payload) {
  const std::optional<Message> answer = answer_to(frame(type, next_sequence, payload));
  EXPECT_TRUE(answer) << "no answer to type " << int{type};
  EXPECT_EQ(answer ? answer->sequence : 0, next_sequence);
  ++next_sequence;
  return answer.value_or(Message{.payload = Bytes(SERVO_PAYLOAD_MAX)});
}

Message Bench::hello(std::uint8_t version) {
  next_sequence = 0;
  return command(SERVO_HELLO, {version});
}

void Bench::open(const servo_configure& configuration, std::int32_t angle_cdeg) {
  EXPECT_EQ(hello().type, SERVO_WELCOME);
  EXPECT_EQ(command(SERVO_CONFIGURE, payload_of(configuration)).type, SERVO_ACK);
  EXPECT_EQ(command(SERVO_ARM, payload_of(servo_arm{angle_cdeg})).type, SERVO_ACK);
}

int reason(const Message& answer) {
  return answer.type == SERVO_NACK ? answer.payload[1] : 0;
}
int reason(const std::optional<Message>& answer) {
  return answer ? reason(*answer) : -1;
}

int count(const Bench& bench, servo_event_kind kind, int detail) {
  return static_cast<int>(std::ranges::count_if(bench.events(), [&](const servo_event& event) {
    return event.kind == kind && event.detail == detail;
  }));
}

void FirmwareTest::SetUp() {
  restart();
  if (!HasFatalFailure() && bench_ == nullptr)
    GTEST_SKIP() << "no AVR image or no simavr beside this program: only the host build is tested";
}

void FirmwareTest::restart() {
  auto firmware = is_avr() ? make_avr_firmware() : simulation::make_host_firmware();
  bench_ = firmware ? std::make_unique<Bench>(std::move(firmware)) : nullptr;
}

}  // namespace thermorig::firmware_test
