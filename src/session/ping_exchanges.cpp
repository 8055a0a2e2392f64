// SPDX-License-Identifier: MIT
#include "ping_exchanges.h"

#include <map>

#include "servo_link.h"

namespace thermorig::session {

namespace {

bool is_ping(const servo_decoder& decoder) {
  return decoder.body[0] == SERVO_PING && servo_decoder_payload_size(&decoder) == SERVO_PING_SIZE;
}

/// Host time of the write() that ended each ping, by token. A token that comes again counts anew.
std::map<std::uint32_t, std::int64_t> ping_times(const RawStream& sent) {
  std::map<std::uint32_t, std::int64_t> times;
  servo_decoder decoder{};
  for (std::size_t i = 0; i < sent.chunk_count(); ++i)
    for (const std::uint8_t byte : sent.chunk(i))
      if (servo_decoder_push(&decoder, byte) == SERVO_DECODED_FRAME && is_ping(decoder))
        times[servo_get_u32(&decoder.body[2])] = sent.time_ns[i];
  return times;
}

}  // namespace

std::vector<PingExchange> ping_exchanges(const std::vector<TimedPong>& pongs, const RawStream& sent) {
  const auto times = ping_times(sent);
  std::vector<PingExchange> exchanges;
  for (const auto& pong : pongs) {
    const auto found = times.find(pong.token);
    exchanges.push_back({pong, found == times.end() ? unknown : found->second});
  }
  return exchanges;
}

}  // namespace thermorig::session
