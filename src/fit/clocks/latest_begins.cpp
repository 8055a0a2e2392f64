// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstddef>

#include "thermorig/fit/clocks/recorded_clock.h"
#include "thermorig/pipeline/timing/link_timing.h"

namespace thermorig::fit {

using namespace timing;

namespace {
constexpr HostTime farthest = host_time_ns(1'000'000'000'000'000'000);  // 30 years: so that sums fit

/// Arrivals of the chunks; one before the arrival of the chunk before counts as equal to it.
std::vector<HostTime> arrivals(const RawStream& received) {
  std::vector<HostTime> times(received.chunk_count());
  HostTime latest = -farthest.time_since_epoch() + HostTime{};
  for (std::size_t i = 0; i < times.size(); ++i)
    times[i] = latest = std::clamp(received.time(i), latest, farthest);
  return times;
}

HostDuration shortest_wire_time(std::uint64_t bytes, std::uint32_t baud) {
  return from_s(shortest_wire_time_s(bytes, baud));
}
}  // namespace

std::vector<LatestBegin> latest_begins(const RawStream& received, std::span<const StreamSpan> spans,
                                       std::span<const double> device_s, std::uint32_t baud) {
  const std::vector<HostTime> arrived = arrivals(received);
  const std::size_t count = std::min(spans.size(), device_s.size());
  std::vector<LatestBegin> result;
  result.reserve(arrived.size());
  std::size_t message = 0;
  double before_s = 0.0;  // on the device's clock: the last byte of the chunk before was sent
  for (std::size_t chunk = 0; chunk < arrived.size(); ++chunk) {
    const std::uint64_t end = received.chunk_end[chunk];
    while (message < count && spans[message].end < end) ++message;
    if (message == count) break;
    if (end <= spans[message].begin) continue;  // it ends in bytes between messages
    const double wire_s = wire_time_s(end - spans[message].begin, baud);
    const double sent_s = device_s[message] + wire_s;
    result.push_back({.device_s = device_s[message],
                      .latest = arrived[chunk] - from_s(wire_s),
                      .inside = end < spans[message].end,
                      .wire_s = wire_s,
                      .held_s = sent_s - before_s});
    before_s = sent_s;
  }
  return result;
}

std::vector<HostTime> earliest_proofs(const RawStream& received, std::span<const StreamSpan> spans,
                                      std::uint32_t baud) {
  const std::vector<HostTime> arrived = arrivals(received);
  std::vector<HostTime> result(spans.size(), HostTime::max());
  std::size_t chunk = arrived.size();
  HostTime stream_begin = HostTime::max();  // latest begin of the stream's first byte, had it never paused
  for (std::size_t i = spans.size(); i-- > 0;) {
    for (; chunk > 0 && received.chunk_end[chunk - 1] > spans[i].begin; --chunk)
      stream_begin = std::min(stream_begin,
                              arrived[chunk - 1] - shortest_wire_time(received.chunk_end[chunk - 1], baud));
    if (stream_begin != HostTime::max()) result[i] = stream_begin + shortest_wire_time(spans[i].begin, baud);
  }
  return result;
}

}  // namespace thermorig::fit
