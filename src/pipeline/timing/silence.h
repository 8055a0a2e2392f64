// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <numbers>

namespace thermorig::timing {

/// Standard deviation of a uniform spread of width 1.
inline constexpr double uniform_deviation = 0.5 / std::numbers::sqrt3;

/// What shows whether a link sends by its own clock or when its line falls silent.
struct LineUse {
  double step_s = 0.0;     // between messages
  double message_s = 0.0;  // of it a message is on the wire; 0 without a baud rate
  std::size_t chunks = 0;  // that ended at or within a message
  std::size_t cuts = 0;    // of those: within
};

/// How long the link may listen before it takes silence for an end; 0 if it does not wait for one. A link
/// that never cuts a message although its line is busy for a good part of the time sends on silence (CH340).
/// How long it listens is constant and in no data sheet: anything up to the pause between messages, or to 3
/// ms.
double longest_silence_s(const LineUse& use);

}  // namespace thermorig::timing
