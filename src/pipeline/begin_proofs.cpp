// SPDX-License-Identifier: MIT
#include "begin_proofs.h"

#include <algorithm>

#include "thermorig/timing/link_timing.h"

namespace thermorig::pipeline {

namespace {
/// Of one message, by the chunks that brought its bytes; `chunk` is the first of them.
HostTime own_proof(const RawStream& received, std::size_t chunk, const StreamSpan& span, double byte_s) {
  HostTime proof = HostTime::max();
  for (; chunk < received.chunk_count(); ++chunk) {
    const std::uint64_t end = received.chunk_end[chunk];
    proof = std::min(proof, received.time(chunk) - from_s(byte_s * static_cast<double>(end - span.begin)));
    if (end >= span.end) break;
  }
  return proof;
}
}  // namespace

std::vector<HostTime> begin_proofs(const RawStream& received, std::span<const StreamSpan> spans,
                                   std::uint32_t baud) {
  const double byte_s = timing::wire_time_s(1, baud);
  std::vector<HostTime> proofs;
  proofs.reserve(spans.size());
  std::size_t chunk = 0;
  for (const StreamSpan& span : spans) {
    while (received.chunk_end[chunk] <= span.begin) ++chunk;
    proofs.push_back(own_proof(received, chunk, span, byte_s));
  }
  // What proves that the next message had begun proves that this one had, its bytes earlier.
  for (std::size_t i = proofs.size(); i-- > 1;) {
    const double apart_s = byte_s * static_cast<double>(spans[i].begin - spans[i - 1].begin);
    proofs[i - 1] = std::min(proofs[i - 1], proofs[i] - from_s(apart_s));
  }
  return proofs;
}

bool holds(const RawStream& received, std::span<const StreamSpan> spans) {
  const auto is_sound = [&](const StreamSpan& span) {
    return span.begin < span.end && span.end <= received.bytes.size();
  };
  const auto by_begin = [](const StreamSpan& a, const StreamSpan& b) { return a.begin < b.begin; };
  return !spans.empty() && std::all_of(spans.begin(), spans.end(), is_sound) &&
         std::is_sorted(spans.begin(), spans.end(), by_begin);
}

}  // namespace thermorig::pipeline
