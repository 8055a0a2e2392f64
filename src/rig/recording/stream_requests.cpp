// SPDX-License-Identifier: MIT
#include "stream_requests.h"

#include <chrono>
#include <utility>

#include "thermorig/sensors/device_stream.h"

namespace thermorig::rig {

namespace {
constexpr HostDuration request_patience = std::chrono::seconds(1);
}  // namespace

std::vector<std::uint8_t> StreamRequests::due(Device device, std::uint64_t messages, HostTime now) {
  Stream& stream = streams_[device];
  if (std::exchange(stream.messages, messages) != messages && stream.since) {
    stream.since = now;
    stream.asked = 0;
    return {};
  }
  if (stream.since && now - *stream.since < request_patience) return {};
  stream.since = now;
  return sensors::stream_request(device, profile_, stream.asked++);
}

}  // namespace thermorig::rig
