// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace thermorig::wire {

using Bytes = std::span<const std::uint8_t>;

/// Calls `step(rest)` along `bytes` until it needs more of them (returns 0); returns how many were used.
template <typename Step>
std::size_t step_along(Bytes bytes, Step& step) {
  std::size_t at = 0;
  while (at < bytes.size()) {
    const std::size_t used = step(bytes.subspan(at));
    if (used == 0) break;
    at += used;
  }
  return at;
}

/// Shows `step` the stream as if it had come in one piece. `step(rest)` returns how many bytes it used, or 0
/// if it needs more; what it decides on some bytes it must also decide on more of them, and it must decide
/// when it sees `longest`. Only messages that straddle two chunks are copied; `pending` stays below
/// `longest`.
template <typename Step>
void reassemble(std::vector<std::uint8_t>& pending, Bytes bytes, std::size_t longest, Step step) {
  while (!pending.empty() && !bytes.empty()) {
    const std::size_t carried = pending.size();
    const std::size_t taken = std::min(bytes.size(), longest - carried);
    pending.insert(pending.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(taken));
    const std::size_t used = step_along(pending, step);
    if (used < carried) {
      pending.erase(pending.begin(), pending.begin() + static_cast<std::ptrdiff_t>(used));
      bytes = bytes.subspan(taken);
    } else {
      pending.clear();
      bytes = bytes.subspan(used - carried);
    }
  }
  if (bytes.empty()) return;
  const std::size_t used = step_along(bytes, step);
  pending.assign(bytes.begin() + static_cast<std::ptrdiff_t>(used), bytes.end());
}

/// The stream has ended: `step`, which must know that, is shown what is pending once more.
template <typename Step>
void reassemble_end(std::vector<std::uint8_t>& pending, Step step) {
  const std::size_t used = step_along(pending, step);
  pending.erase(pending.begin(), pending.begin() + static_cast<std::ptrdiff_t>(used));
}

/// How many bytes come before the first `sync`; all of them if there is none.
std::size_t bytes_before(std::uint8_t sync, Bytes bytes);

/// Little-endian numbers at `bytes[at]`.
inline std::uint16_t u16_at(Bytes bytes, std::size_t at) {
  return static_cast<std::uint16_t>(bytes[at] | (bytes[at + 1] << 8));
}
inline std::int16_t i16_at(Bytes bytes, std::size_t at) {
  return static_cast<std::int16_t>(u16_at(bytes, at));
}

}  // namespace thermorig::wire
