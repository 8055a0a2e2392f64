// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/timing/link_timing.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "thermorig/pipeline/timing/least_lateness.h"

namespace thermorig::timing {

namespace {
constexpr HostDuration farthest_from_start{1'000'000'000'000'000'000};  // 30 years: so that sums fit
}  // namespace

LinkTiming::LinkTiming(const PortProfile& link, double nominal_rate_hz)
    : link_(link),
      nominal_rate_hz_(nominal_rate_hz),
      byte_s_(wire_time_s(1, link.baud)),
      latency_(from_s(link.latency_s)),
      constant_delay_s_(link.largest_constant_delay_s) {
  if (!(nominal_rate_hz > 0.0) || !std::isfinite(nominal_rate_hz)) return;
  clock_.emplace(link, nominal_rate_hz);
}

/// The message's first byte began no later than that, since the chunk's last byte had arrived.
HostTime LinkTiming::begin_before(const TimedChunk& chunk, const StreamSpan& span) const {
  return chunk.arrived - from_s(byte_s_ * static_cast<double>(chunk.end - span.begin));
}

/// Of a chunk that ended at or within the message.
void LinkTiming::add_read(const TimedChunk& chunk, const StreamSpan& span) {
  reads_.push_back({.latest = begin_before(chunk, span),
                    .inside = chunk.end < span.end,
                    .wire_s = byte_s_ * static_cast<double>(chunk.end - span.begin)});
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

void LinkTiming::forget_clock() {
  if (clock_) clock_.emplace(link_, nominal_rate_hz_);
}

void LinkTiming::restart() {
  if (!chunks_.empty()) begin_ = chunks_.back().end;
  chunks_.clear();
  last_end_ = begin_;
  forget_clock();
}

Stamp LinkTiming::stamp(const StreamSpan& span, const StampHint& hint) {
  assert(!chunks_.empty() && span.end <= chunks_.back().end && span.begin <= span.end);
  reads_.clear();
  for (; chunks_.size() > 1 && chunks_.front().end < span.end; chunks_.pop_front())
    if (chunks_.front().end > span.begin) add_read(chunks_.front(), span);
  const TimedChunk& chunk = chunks_.front();
  if (chunk.end == span.end) add_read(chunk, span);
  const HostTime by_last_byte = begin_before(chunk, span);
  HostTime latest = by_last_byte;
  for (const LatestBegin& read : reads_) latest = std::min(latest, read.latest);
  std::optional<HostTime> placed;
  if (clock_)
    placed = clock_->place({.latest = latest,
                            .reads = reads_,
                            .lost_before = lost_before(span, hint),
                            .device_s = hint.device_s,
                            .left_out = hint.lost_before && span.begin <= last_end_});
  last_end_ = span.end;
  newest_ = std::max(newest_, placed.value_or(by_last_byte) - latency_);
  const HostTime proven = std::max(latest - latency_, newest_);
  Stamp stamp{.time = newest_, .arrival = chunk.arrived};
  const double baud_s = baud_tolerance * byte_s_ * static_cast<double>(chunk.end - span.begin);
  stamp.later_s = static_cast<float>(to_s(proven - newest_) + baud_s);
  if (placed) {
    const Estimate& least_s = clock_->least_lateness_s();
    const double late_s = constant_delay_s_ + clock_->longest_silence_s() - least_s.value;
    stamp.uncertainty_s = static_cast<float>(least_s.uncertainty);
    stamp.earlier_s = static_cast<float>(std::max(0.0, late_s) + clock_->drift_s() + baud_s);
  } else {
    stamp.uncertainty_s = uncertainty_s(chunk);
    stamp.earlier_s = static_cast<float>(longest_hold_s + baud_s);
  }
  return stamp;
}

}  // namespace thermorig::timing
