// SPDX-License-Identifier: MIT
#include "stream_requests.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "thermorig/sensors/device_stream.h"

namespace thermorig::rig {

namespace {
constexpr HostDuration request_patience = std::chrono::seconds(1);
constexpr double patience_periods = 3.0;  // of a device that sends more seldom
}  // namespace

std::vector<std::uint8_t> StreamRequests::due(Device device, std::uint64_t messages, HostTime now,
                                              std::uint64_t refused) {
  Stream& stream = streams_[device];
  if (!stream.commands.empty()) return next_command(stream, now);
  const std::uint64_t before = std::exchange(stream.messages, messages);
  if (before != messages && stream.since) {
    stream.since = now;
    stream.asked = 0;
    return asks_for(device, messages - before + refused - std::exchange(stream.refused, refused));
  }
  const double period_s = 1.0 / sensors::device_stream(device, profile_).rate_hz;
  const HostDuration patience = std::max(request_patience, from_s(patience_periods * period_s));
  if (stream.since && now - *stream.since < patience) return {};
  stream.since = now;
  stream.refused = refused;
  const sensors::Commands commands = sensors::stream_request(device, profile_, stream.asked++);
  stream.commands.assign(commands.begin(), commands.end());
  return next_command(stream, now);
}

std::vector<std::uint8_t> StreamRequests::asks_for(Device device, std::uint64_t messages) const {
  const std::vector<std::uint8_t> once = sensors::next_request(device, profile_);
  std::vector<std::uint8_t> bytes;
  for (std::uint64_t i = 0; i < messages && !once.empty(); ++i)
    bytes.insert(bytes.end(), once.begin(), once.end());
  return bytes;
}

std::vector<std::uint8_t> StreamRequests::next_command(Stream& stream, HostTime now) {
  if (stream.commands.empty() || now < stream.next_command) return {};
  std::vector<std::uint8_t> command = std::move(stream.commands.front());
  stream.commands.pop_front();
  stream.next_command = now + sensors::command_gap;
  return command;
}

}  // namespace thermorig::rig
