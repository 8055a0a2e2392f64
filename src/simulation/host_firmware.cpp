// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cassert>
#include <deque>
#include <limits>
#include <optional>

#include "thermorig/simulation/firmware.h"

extern "C" {
#include "servo.h"
}

namespace thermorig::simulation {
namespace {

constexpr std::int64_t tick_us = SERVO_TICK_US;
constexpr std::int64_t period_us = SERVO_PULSE_PERIOD_US;
constexpr std::int64_t byte_us = 10'000'000 / static_cast<std::int64_t>(SERVO_LINK_BAUD);
constexpr std::uint8_t power_on_reset = 1;  // PORF of an AVR's MCUSR
constexpr std::int64_t never = std::numeric_limits<std::int64_t>::max();

/// A board without registers: it does what firmware_servo/board_avr.c does, at once and in virtual time.
class HostFirmware final : public Firmware {
 public:
  HostFirmware() {
    servo_init(&servo_, SERVO_BOARD_HOST, power_on_reset);
    transmit(0);
  }

  void receive(std::uint8_t byte, std::int64_t time_us) override {
    assert(time_us >= now_us_);
    received_.push_back({std::max(time_us, now_us_), byte});
  }

  void sense(const SensorRegisters& registers) override { sensor_ = registers; }

  FirmwareOutput run_until(std::int64_t time_us) override {
    FirmwareOutput output;
    while (next_event_us() <= time_us) take_next_event(output);
    now_us_ = std::max(now_us_, time_us);
    while (!sent_.empty() && sent_.front().time_us <= now_us_) {
      output.bytes.push_back(sent_.front());
      sent_.pop_front();
    }
    end_pulse(now_us_, output);
    return output;
  }

  std::string description() const override { return "host build"; }

 private:
  std::int64_t byte_event_us() const { return received_.empty() ? never : received_.front().time_us; }
  std::int64_t pong_event_us() const {
    if (!servo_.ping.waiting) return never;
    const auto wait = static_cast<std::int32_t>(servo_.ping.due_us - static_cast<std::uint32_t>(now_us_));
    return std::max(now_us_ + wait, last_start_us_);
  }
  std::int64_t next_event_us() const { return std::min({byte_event_us(), pong_event_us(), next_tick_us_}); }

  // At the same instant bytes come before the tick and the tick before the pong, as in the AVR's main loop.
  void take_next_event(FirmwareOutput& output) {
    now_us_ = std::max(now_us_, next_event_us());
    if (byte_event_us() <= now_us_)
      take_byte();
    else if (next_tick_us_ <= now_us_)
      tick(output);
    else
      answer_ping();
    transmit(now_us_);
  }

  void take_byte() {
    servo_receive(&servo_, received_.front().value, static_cast<std::uint32_t>(now_us_));
    received_.pop_front();
  }

  // A pulse starts with each period; its width is set in the last tick of the period before.
  void tick(FirmwareOutput& output) {
    const std::int64_t in_period_us = next_tick_us_ % period_us;
    end_pulse(next_tick_us_, output);
    if (in_period_us == 0) start_pulse();
    servo_tick(&servo_, static_cast<std::uint32_t>(next_tick_us_));
    encoder_transfer transfer;
    if (servo_encoder_next(&servo_, &transfer)) carry_out(transfer, output);
    if (in_period_us == period_us - tick_us) next_pulse_ticks_ = servo_next_pulse(&servo_);
    next_tick_us_ += tick_us;
  }

  /// At once, though on the AVR it takes a fifth of a tick.
  void carry_out(const encoder_transfer& transfer, FirmwareOutput& output) {
    std::array<std::uint8_t, ENCODER_READ_MAX> read{};
    const bool acknowledged = sensor_ && sensor_->bus != SensorBus::silent;
    for (std::uint8_t i = 0; acknowledged && i < transfer.read_size; ++i)
      read[i] = register_byte(*sensor_, static_cast<std::uint8_t>(transfer.write[0] + i));
    for (std::uint8_t i = 1; acknowledged && i < transfer.write_size; ++i)
      output.writes.push_back({static_cast<std::uint8_t>(transfer.write[0] + i - 1), transfer.write[i]});
    servo_encoder_done(&servo_, acknowledged, read.data(), static_cast<std::uint32_t>(next_tick_us_));
  }

  void start_pulse() {
    servo_pulse_started(&servo_, next_pulse_ticks_);
    if (next_pulse_ticks_ != 0)
      pulse_ = PulseEdge{next_tick_us_, next_pulse_ticks_ / double{SERVO_TICKS_PER_US}};
  }

  void end_pulse(std::int64_t time_us, FirmwareOutput& output) {
    if (!pulse_ || static_cast<double>(pulse_->rise_us) + pulse_->width_us > static_cast<double>(time_us))
      return;
    output.pulses.push_back(*pulse_);
    pulse_.reset();
  }

  void answer_ping() {
    send(SERVO_LINK_FLAG, now_us_);
    servo_answer_ping(&servo_, static_cast<std::uint32_t>(now_us_));
  }

  void transmit(std::int64_t time_us) {
    while (!servo_output_is_empty(&servo_.output)) send(servo_output_take(&servo_.output), time_us);
  }

  void send(std::uint8_t byte, std::int64_t time_us) {
    last_start_us_ = std::max(time_us, last_start_us_ + byte_us);
    sent_.push_back({last_start_us_, byte});
  }

  servo servo_{};
  std::optional<SensorRegisters> sensor_;
  std::deque<UartByte> received_;
  std::deque<UartByte> sent_;
  std::optional<PulseEdge> pulse_;
  std::uint16_t next_pulse_ticks_ = 0;
  std::int64_t now_us_ = 0;
  std::int64_t next_tick_us_ = tick_us;
  std::int64_t last_start_us_ = -byte_us;  // of the byte sent last
};

}  // namespace

std::uint8_t register_byte(const SensorRegisters& registers, std::uint8_t address) {
  if (registers.bus == SensorBus::hangs_high) return 0xFF;
  switch (address) {
    case 0x0B:
      return registers.status;
    case 0x0C:
    case 0x0E:  // ANGLE: RAW ANGLE, as no range is set
      return static_cast<std::uint8_t>(registers.raw >> 8U);
    case 0x0D:
    case 0x0F:
      return static_cast<std::uint8_t>(registers.raw & 0xFFU);
    case 0x1A:
      return registers.gain;
    default:
      return 0;
  }
}

std::unique_ptr<Firmware> make_host_firmware() {
  return std::make_unique<HostFirmware>();
}

}  // namespace thermorig::simulation
