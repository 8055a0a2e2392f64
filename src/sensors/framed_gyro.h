// SPDX-License-Identifier: MIT
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "framed_scanner.h"
#include "text_words.h"
#include "thermorig/sensors/gyro_protocol.h"

namespace thermorig::sensors {

/// What a gyro's frame holds.
struct FrameContent {
  using Kind = FrameKind;
  using Message = wire::GyroMessage;
  Kind kind = Kind::reply;
  GyroReading reading = {};  // of a sample

  static FrameContent bad(Kind why) { return {.kind = why}; }
  void append_to(std::vector<Message>& out, const StreamSpan& span, bool gap) const {
    if (kind == Kind::sample) out.push_back({reading, span, gap});
  }
};

/// A sample; a value that cannot be used where a rate is infinite or not a number, or the time is before 0.
inline FrameContent sample_or_bad_value(const GyroReading& reading) {
  const bool is_finite = std::all_of(reading.rate_dps.begin(), reading.rate_dps.end(),
                                     [](float rate_dps) { return std::isfinite(rate_dps); });
  if (!is_finite || reading.device_time_us.value_or(0) < 0)
    return FrameContent::bad(FrameContent::Kind::bad_value);
  return {.kind = FrameContent::Kind::sample, .reading = reading};
}

/// What the scanner finds in bytes that are looked at once: its counters, and what `Framing` has kept.
template <typename Framing>
FramedScanner<Framing> scanned(Framing framing, wire::Bytes bytes) {
  FramedScanner<Framing> scanner(std::move(framing));
  std::vector<wire::GyroMessage> messages;
  scanner.push(bytes, messages);
  scanner.finish(messages);
  return scanner;
}

/// Evidence of a protocol: nothing where fewer than two frames are good. `frames`: what they are called.
/// `without_rates`: what to try where none of them holds rates.
inline std::optional<Evidence> framed_evidence(const wire::Counters& counters, std::string_view frames,
                                               std::string_view held, std::string without_rates) {
  const std::uint64_t good = counters.messages + counters.replies;
  if (good < 2) return std::nullopt;
  Evidence evidence{.messages = counters.messages,
                    .bytes = counters.bytes_in_messages,
                    .text = fmt::format("{} {}, {} of a gyro", good, frames, counters.messages),
                    .text_format = {}};
  if (counters.messages > 0) return evidence;
  evidence.text = fmt::format("no rates of turn among {} good {}{}", good, frames, held);
  evidence.advice = std::move(without_rates);
  return evidence;
}

/// All of the bytes as one number, the first being the highest.
inline std::uint64_t big_endian(wire::Bytes bytes) {
  std::uint64_t number = 0;
  for (const std::uint8_t byte : bytes) number = number << 8U | byte;
  return number;
}
inline float big_endian_float(wire::Bytes bytes) {
  return std::bit_cast<float>(static_cast<std::uint32_t>(big_endian(bytes.first(4))));
}

}  // namespace thermorig::sensors
