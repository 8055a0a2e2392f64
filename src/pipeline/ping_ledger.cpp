// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/ping_ledger.h"

#include <algorithm>

#include "servo_link.h"
#include "thermorig/pipeline/timing/link_timing.h"
#include "thermorig/sensors/wire/sent_commands.h"

namespace thermorig::pipeline {

namespace {
/// The servo's 32 bits count on from a message whose unwrapped time is known; they may lie a little before.
std::int64_t unwrapped_near(const TimedServo& telemetry, std::uint32_t mcu_us) {
  return telemetry.mcu_time_us + static_cast<std::int32_t>(mcu_us - telemetry.state.mcu_us);
}
}  // namespace

void PingLedger::sent(std::span<const std::uint8_t> bytes, HostTime before_write) {
  for (const wire::SentFrame& frame : wire::read_sent(bytes)) {
    if (frame.type != SERVO_PING) continue;
    const HostDuration wire_time = from_s(shortest_wire_time_s(frame.span.end, baud_));
    pings_.push_back({servo_get_u32(frame.payload.data()), before_write, before_write + wire_time});
    if (pings_.size() > remembered) pings_.pop_front();
  }
}

std::optional<timing::PingBound> PingLedger::exchange(const TimedPong& pong, const TimedServo& telemetry,
                                                      HostTime not_after) const {
  const auto is_asked = [&](const Ping& ping) {
    return ping.token == pong.token && ping.written <= pong.arrival;
  };
  const auto ping = std::find_if(pings_.rbegin(), pings_.rend(), is_asked);
  if (ping == pings_.rend()) return std::nullopt;
  return timing::PingBound{.receive_us = unwrapped_near(telemetry, pong.receive_us),
                           .not_before = ping->received_not_before,
                           .send_us = unwrapped_near(telemetry, pong.send_us),
                           .not_after = not_after};
}

}  // namespace thermorig::pipeline
