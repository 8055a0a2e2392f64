// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "thermorig/core/chunk.h"
#include "thermorig/core/raw_recording.h"

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

}  // namespace thermorig::fit
