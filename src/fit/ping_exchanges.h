// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "thermorig/core/chunk.h"
#include "thermorig/core/raw_recording.h"
#include "thermorig/pipeline/pipeline.h"
#include "thermorig/pipeline/timing/ping_clock.h"

namespace thermorig::fit {

/// Where the messages stand in their stream.
template <typename Messages>
std::vector<StreamSpan> spans_of(const Messages& messages) {
  std::vector<StreamSpan> spans;
  spans.reserve(messages.size());
  for (const auto& message : messages) spans.push_back(message.span);
  return spans;
}

/// True if there are messages, and the bytes and arrivals that they came from.
inline bool holds(const RawStream& received, std::span<const StreamSpan> spans) {
  const auto is_sound = [&](const StreamSpan& span) {
    return span.begin < span.end && span.end <= received.bytes.size();
  };
  const auto by_begin = [](const StreamSpan& a, const StreamSpan& b) { return a.begin < b.begin; };
  return !spans.empty() && std::all_of(spans.begin(), spans.end(), is_sound) &&
         std::is_sorted(spans.begin(), spans.end(), by_begin);
}

// What a recording says about the servo's clock, in the words of fit_pings.

/// Each answer with its ping. Answers whose ping is not in `sent` are left out.
std::vector<timing::PingBound> ping_exchanges(const RawStream& received, const RawStream& sent,
                                              const pipeline::Streams& streams, std::uint32_t baud);

/// Of a ping to the servo and its answer, what the servo held it back taken off. None without an answer.
std::optional<double> shortest_round_trip_s(const std::vector<timing::PingBound>& exchanges);

/// Telemetry: mcu_us is taken when the message is composed, before its first byte goes out.
std::vector<timing::PingBound> sent_stamps(const RawStream& received, const std::vector<TimedServo>& servo,
                                           std::uint32_t baud);

std::vector<std::int64_t> mcu_times_us(const std::vector<TimedServo>& servo);

}  // namespace thermorig::fit
