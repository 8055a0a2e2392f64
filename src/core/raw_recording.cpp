// SPDX-License-Identifier: MIT
#include "thermorig/core/raw_recording.h"

namespace thermorig {

void RawStream::append(std::span<const std::uint8_t> chunk, HostTime time) {
  bytes.insert(bytes.end(), chunk.begin(), chunk.end());
  chunk_end.push_back(bytes.size());
  time_ns.push_back(to_ns(time));
}

std::span<const std::uint8_t> RawStream::chunk(std::size_t index) const {
  const std::uint64_t begin = index == 0 ? 0 : chunk_end[index - 1];
  return std::span(bytes).subspan(begin, chunk_end[index] - begin);
}

}  // namespace thermorig
