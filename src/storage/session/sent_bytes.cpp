// SPDX-License-Identifier: MIT
#include "sent_bytes.h"

#include <algorithm>

#include "servo_link.h"
#include "thermorig/sensors/wire/sent_commands.h"

namespace thermorig::session {

namespace {

/// Host time of the write() that carried the byte at `offset`.
std::int64_t time_ns_of(const RawStream& sent, std::uint64_t offset) {
  const auto end = std::upper_bound(sent.chunk_end.begin(), sent.chunk_end.end(), offset);
  return sent.time_ns[static_cast<std::size_t>(end - sent.chunk_end.begin())];
}

struct PingTime {
  std::uint32_t token;
  std::int64_t time_ns;
};

/// Host time of the write() that ended each ping, ordered by token; where one comes again, in their order.
std::vector<PingTime> ping_times(const RawStream& sent) {
  std::vector<PingTime> times;
  wire::for_each_sent(sent.bytes, [&](const wire::SentFrame& frame) {
    if (frame.type == SERVO_PING)
      times.push_back({servo_get_u32(frame.payload.data()), time_ns_of(sent, frame.span.end - 1)});
  });
  std::stable_sort(times.begin(), times.end(),
                   [](const PingTime& a, const PingTime& b) { return a.token < b.token; });
  return times;
}

/// Of the last ping with the token.
std::int64_t time_ns_of(const std::vector<PingTime>& times, std::uint32_t token) {
  const auto after =
      std::upper_bound(times.begin(), times.end(), token,
                       [](std::uint32_t one, const PingTime& ping) { return one < ping.token; });
  return after == times.begin() || (after - 1)->token != token ? unknown : (after - 1)->time_ns;
}

}  // namespace

std::string sent_group(Device to) {
  return to == Device::servo ? "sent" : "sent_" + std::string(name_of(to));
}

std::vector<PingExchange> ping_exchanges(const std::vector<TimedPong>& pongs, const RawStream& sent) {
  const std::vector<PingTime> times = ping_times(sent);
  std::vector<PingExchange> exchanges;
  for (const auto& pong : pongs) exchanges.push_back({pong, time_ns_of(times, pong.token)});
  return exchanges;
}

std::vector<TimedCommand> timed_commands(const RawStream& sent) {
  std::vector<TimedCommand> commands;
  wire::for_each_sent(sent.bytes, [&](const wire::SentFrame& frame) {
    if (wire::is_command(frame))
      commands.push_back({host_time_ns(time_ns_of(sent, frame.span.begin)), wire::command_text(frame)});
  });
  return commands;
}

}  // namespace thermorig::session
