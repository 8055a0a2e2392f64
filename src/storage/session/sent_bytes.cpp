// SPDX-License-Identifier: MIT
#include "sent_bytes.h"

#include <algorithm>
#include <map>

#include "servo_link.h"
#include "thermorig/sensors/wire/sent_commands.h"

namespace thermorig::session {

namespace {

/// Host time of the write() that carried the byte at `offset`.
std::int64_t time_ns_of(const RawStream& sent, std::uint64_t offset) {
  const auto end = std::upper_bound(sent.chunk_end.begin(), sent.chunk_end.end(), offset);
  return sent.time_ns[static_cast<std::size_t>(end - sent.chunk_end.begin())];
}

/// Host time of the write() that ended each ping, by token. A token that comes again counts anew.
std::map<std::uint32_t, std::int64_t> ping_times(const std::vector<wire::SentFrame>& frames,
                                                 const RawStream& sent) {
  std::map<std::uint32_t, std::int64_t> times;
  for (const wire::SentFrame& frame : frames)
    if (frame.type == SERVO_PING)
      times[servo_get_u32(frame.payload.data())] = time_ns_of(sent, frame.span.end - 1);
  return times;
}

}  // namespace

std::string sent_group(Device to) {
  return to == Device::servo ? "sent" : "sent_" + std::string(name_of(to));
}

std::vector<PingExchange> ping_exchanges(const std::vector<TimedPong>& pongs, const RawStream& sent) {
  const auto times = ping_times(wire::read_sent(sent.bytes), sent);
  std::vector<PingExchange> exchanges;
  for (const auto& pong : pongs) {
    const auto found = times.find(pong.token);
    exchanges.push_back({pong, found == times.end() ? unknown : found->second});
  }
  return exchanges;
}

std::vector<TimedCommand> timed_commands(const RawStream& sent) {
  std::vector<TimedCommand> commands;
  for (const wire::SentFrame& frame : wire::read_sent(sent.bytes))
    if (wire::is_command(frame))
      commands.push_back({host_time_ns(time_ns_of(sent, frame.span.begin)), wire::command_text(frame)});
  return commands;
}

}  // namespace thermorig::session
