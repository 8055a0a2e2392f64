// SPDX-License-Identifier: MIT
#include <cassert>
#include <limits>

#include "checksums.h"
#include "reassembly.h"
#include "thermorig/wire/device_bytes.h"
#include "thermorig/wire/gyro_scanner.h"
#include "witmotion.h"

namespace thermorig::wire {

namespace {

bool is_known_type(std::uint8_t type) {
  return (type >= witmotion::type_first && type <= witmotion::type_last) || type == witmotion::type_register;
}

bool is_packet_start(Bytes rest) {
  return rest[0] == witmotion::sync && is_known_type(rest[1]);
}

bool is_good(Bytes rest) {
  return is_packet_start(rest) && byte_sum8(rest.first(witmotion::sum_offset)) == rest[witmotion::sum_offset];
}

/// Whether a packet may stand before these bytes: another good one, or what the stream's end left of one.
bool is_followed_well(Bytes rest) {
  if (rest.size() >= witmotion::packet_bytes) return is_good(rest);
  return rest.empty() || (rest[0] == witmotion::sync && (rest.size() == 1 || is_packet_start(rest)));
}

bool is_at_range_end(std::int16_t count) {
  return count == std::numeric_limits<std::int16_t>::max() ||
         count == std::numeric_limits<std::int16_t>::min();
}

GyroReading read_packet(Bytes rest) {
  GyroReading reading;
  for (std::size_t axis = 0; axis < reading.counts.size(); ++axis) {
    reading.counts[axis] = i16_at(rest, witmotion::words_offset + 2 * axis);
    reading.rate_dps[axis] = static_cast<float>(reading.counts[axis] * witmotion_dps_per_count);
    reading.saturated |= is_at_range_end(reading.counts[axis]);
  }
  const std::int16_t temperature = i16_at(rest, witmotion::words_offset + 2 * reading.counts.size());
  reading.temp_c = static_cast<float>(temperature / witmotion::temperature_counts_per_kelvin);
  return reading;
}

}  // namespace

void WitmotionScanner::push(std::span<const std::uint8_t> bytes, std::vector<GyroMessage>& out) {
  assert(!ended_);
  ledger_.receive(bytes.size());
  reassemble(pending_, bytes, 2 * witmotion::packet_bytes, [&](Bytes rest) { return step(rest, out); });
  assert(pending_.size() == ledger_.counters.bytes_pending);
}

void WitmotionScanner::finish(std::vector<GyroMessage>& out) {
  ended_ = true;
  reassemble_end(pending_, [&](Bytes rest) { return step(rest, out); });
  assert(pending_.size() == ledger_.counters.bytes_pending);
}

std::size_t WitmotionScanner::step(Bytes rest, std::vector<GyroMessage>& out) {
  if (rest[0] != witmotion::sync) return skip(bytes_before(witmotion::sync, rest));
  if (rest.size() < 2) return 0;
  if (!is_packet_start(rest)) return skip(1);
  if (!locked_) return search(rest, out);
  if (rest.size() < witmotion::packet_bytes) return 0;
  if (is_good(rest)) return take_packet(rest, out);
  ++ledger_.counters.bad_checksum;
  ledger_.mark_damage(witmotion::packet_bytes);
  return skip(1);
}

std::size_t WitmotionScanner::search(Bytes rest, std::vector<GyroMessage>& out) {
  if (rest.size() < witmotion::packet_bytes) return 0;
  if (!ended_ && rest.size() < 2 * witmotion::packet_bytes) return 0;
  if (!is_good(rest) || !is_followed_well(rest.subspan(witmotion::packet_bytes))) return skip(1);
  locked_ = true;
  return take_packet(rest, out);
}

std::size_t WitmotionScanner::take_packet(Bytes rest, std::vector<GyroMessage>& out) {
  const StreamSpan span = ledger_.book_message(witmotion::packet_bytes);
  if (rest[1] == witmotion::type_gyro) {
    out.push_back({read_packet(rest), span, ledger_.take_gap()});
    ++ledger_.counters.messages;
  } else {
    ++ledger_.counters.replies;
  }
  return witmotion::packet_bytes;
}

std::size_t WitmotionScanner::skip(std::size_t bytes) {
  locked_ = false;
  ledger_.book_gap(bytes);
  return bytes;
}

}  // namespace thermorig::wire
