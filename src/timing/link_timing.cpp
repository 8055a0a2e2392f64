// SPDX-License-Identifier: MIT
#include "thermorig/timing/link_timing.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <numbers>

namespace thermorig::timing {

namespace {
constexpr double bits_per_byte = 10.0;                           // 8N1: start, 8 data, stop
constexpr double uniform_deviation = 0.5 / std::numbers::sqrt3;  // of a spread of width 1
}  // namespace

double wire_time_s(std::uint64_t bytes, std::uint32_t baud) {
  return baud == 0 ? 0.0 : bits_per_byte * static_cast<double>(bytes) / static_cast<double>(baud);
}

LinkBudget link_budget(std::uint64_t bytes_per_message, double rate_hz, std::uint32_t baud) {
  const double message_s = wire_time_s(bytes_per_message, baud);
  if (message_s <= 0.0) return {.load = 0.0, .max_rate_hz = std::numeric_limits<double>::infinity()};
  return {.load = rate_hz * message_s, .max_rate_hz = 1.0 / message_s};
}

LinkTiming::LinkTiming(const PortProfile& link, double)
    : byte_s_(wire_time_s(1, link.baud)), latency_(from_s(link.latency_s)) {}

float LinkTiming::uncertainty_s(const TimedChunk& chunk) const {
  const double slack_s = to_s(chunk.since_before) - byte_s_ * static_cast<double>(chunk.end - chunk.begin);
  return static_cast<float>(std::clamp(slack_s, 0.0, longest_hold_s) * uniform_deviation);
}

void LinkTiming::chunk(std::uint64_t end, HostTime arrived) {
  TimedChunk chunk{0, end, arrived, HostDuration::max()};
  if (!chunks_.empty()) {
    const TimedChunk& before = chunks_.back();
    chunk.begin = before.end;
    chunk.arrived = std::max(arrived, before.arrived);
    chunk.since_before = chunk.arrived - before.arrived;
  }
  assert(chunk.end >= chunk.begin);
  if (chunk.end == chunk.begin) return;
  chunks_.push_back(chunk);
  while (chunks_.front().end + history_bytes < chunk.begin) chunks_.pop_front();
}

Stamp LinkTiming::stamp(const StreamSpan& span, const StampHint&) {
  assert(!chunks_.empty() && span.end <= chunks_.back().end && span.begin <= span.end);
  while (chunks_.size() > 1 && chunks_.front().end < span.end) chunks_.pop_front();
  const TimedChunk& chunk = chunks_.front();
  const HostTime sent =
      chunk.arrived - from_s(byte_s_ * static_cast<double>(chunk.end - span.begin)) - latency_;
  newest_ = std::max(newest_, sent);
  return {.time = newest_, .arrival = chunk.arrived, .uncertainty_s = uncertainty_s(chunk)};
}

}  // namespace thermorig::timing
