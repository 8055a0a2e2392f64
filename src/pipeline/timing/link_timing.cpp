// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/timing/link_timing.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "silence.h"

namespace thermorig::timing {

namespace {
constexpr double bits_per_byte = 10.0;                                  // 8N1: start, 8 data, stop
constexpr HostDuration farthest_from_start{1'000'000'000'000'000'000};  // 30 years: so that sums fit
}  // namespace

double wire_time_s(std::uint64_t bytes, std::uint32_t baud) {
  return baud == 0 ? 0.0 : bits_per_byte * static_cast<double>(bytes) / static_cast<double>(baud);
}

double shortest_wire_time_s(std::uint64_t bytes, std::uint32_t baud) {
  return wire_time_s(bytes, baud) / (1.0 + baud_tolerance);
}

LinkBudget link_budget(std::uint64_t bytes_per_message, double rate_hz, std::uint32_t baud) {
  const double message_s = wire_time_s(bytes_per_message, baud);
  if (message_s <= 0.0) return {.load = 0.0, .max_rate_hz = std::numeric_limits<double>::infinity()};
  return {.load = rate_hz * message_s, .max_rate_hz = 1.0 / message_s};
}

LinkTiming::LinkTiming(const PortProfile& link, double nominal_rate_hz)
    : link_(link),
      nominal_rate_hz_(nominal_rate_hz),
      byte_s_(wire_time_s(1, link.baud)),
      latency_(from_s(link.latency_s)),
      constant_delay_s_(link.largest_constant_delay_s) {
  if (!(nominal_rate_hz > 0.0) || !std::isfinite(nominal_rate_hz)) return;
  period_s_ = 1.0 / nominal_rate_hz;
  clock_.emplace(link, nominal_rate_hz);
}

double LinkTiming::silence_s(const StreamSpan& span) const {
  return longest_silence_s({.step_s = period_s_,
                            .message_s = byte_s_ * static_cast<double>(span.size()),
                            .chunks = ends_,
                            .cuts = cuts_});
}

/// The message's first byte began no later than that, since the chunk's last byte had arrived.
HostTime LinkTiming::begin_before(const TimedChunk& chunk, const StreamSpan& span) const {
  return chunk.arrived - from_s(byte_s_ * static_cast<double>(chunk.end - span.begin));
}

float LinkTiming::uncertainty_s(const TimedChunk& chunk) const {
  const double slack_s = to_s(chunk.since_before) - byte_s_ * static_cast<double>(chunk.end - chunk.begin);
  return static_cast<float>(std::clamp(slack_s, 0.0, longest_hold_s) * uniform_deviation);
}

/// How many messages of this one's size fit into the bytes that were skipped before it.
double LinkTiming::lost_before(const StreamSpan& span, const StampHint& hint) const {
  if (!hint.lost_before || span.size() == 0) return 0.0;
  const double skipped = span.begin > last_end_ ? static_cast<double>(span.begin - last_end_) : 0.0;
  return std::max(1.0, std::round(skipped / static_cast<double>(span.size())));
}

void LinkTiming::chunk(std::uint64_t end, HostTime arrived) {
  arrived = std::clamp(arrived, HostTime(-farthest_from_start), HostTime(farthest_from_start));
  TimedChunk chunk{begin_, end, arrived, HostDuration::max()};
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

void LinkTiming::restart() {
  if (!chunks_.empty()) begin_ = chunks_.back().end;
  chunks_.clear();
  last_end_ = begin_;
  if (clock_) clock_.emplace(link_, nominal_rate_hz_);
}

Stamp LinkTiming::stamp(const StreamSpan& span, const StampHint& hint) {
  assert(!chunks_.empty() && span.end <= chunks_.back().end && span.begin <= span.end);
  HostTime latest = HostTime::max();
  bool tight = false;
  for (; chunks_.size() > 1 && chunks_.front().end < span.end; chunks_.pop_front()) {
    if (chunks_.front().end <= span.begin) continue;
    latest = std::min(latest, begin_before(chunks_.front(), span));
    tight = true;
    ++ends_;
    ++cuts_;
  }
  const TimedChunk& chunk = chunks_.front();
  const HostTime by_last_byte = begin_before(chunk, span);
  if (chunk.end == span.end) {
    tight = true;
    ++ends_;
  }
  latest = std::min(latest, by_last_byte);
  std::optional<HostTime> placed;
  if (clock_)
    placed = clock_->place({.latest = latest,
                            .tight = tight,
                            .lost_before = lost_before(span, hint),
                            .device_s = hint.device_s,
                            .left_out = hint.lost_before && span.begin <= last_end_});
  last_end_ = span.end;
  const double silent_s = placed ? silence_s(span) : 0.0;
  if (placed) *placed -= from_s(0.5 * silent_s);
  newest_ = std::max(newest_, placed.value_or(by_last_byte) - latency_);
  const HostTime proven = std::max(latest - latency_, newest_);
  Stamp stamp{.time = newest_, .arrival = chunk.arrived};
  const double baud_s = baud_tolerance * byte_s_ * static_cast<double>(chunk.end - span.begin);
  stamp.later_s = static_cast<float>(to_s(proven - newest_) + baud_s);
  if (placed) {
    stamp.uncertainty_s = static_cast<float>(std::hypot(constant_delay_s_, silent_s) * uniform_deviation);
    stamp.earlier_s = static_cast<float>(constant_delay_s_ + silent_s + clock_->drift_s() + baud_s);
  } else {
    stamp.uncertainty_s = uncertainty_s(chunk);
    stamp.earlier_s = static_cast<float>(longest_hold_s + baud_s);
  }
  return stamp;
}

}  // namespace thermorig::timing
