// SPDX-License-Identifier: MIT
// WitMotion sensors. Source: protocols/witmotion.md.
#include "witmotion.h"

#include <fmt/format.h>

#include <array>
#include <cassert>
#include <limits>

#include "foreign_bytes.h"
#include "thermorig/sensors/gyro_protocol.h"
#include "thermorig/sensors/wire/byte_ledger.h"
#include "thermorig/sensors/wire/checksums.h"
#include "thermorig/sensors/wire/reassembly.h"

namespace thermorig::sensors {

namespace {

using wire::Bytes;
using wire::GyroMessage;

constexpr double dps_per_count = witmotion::full_scale_dps / witmotion::counts_full_scale;

bool is_known_type(std::uint8_t type) {
  return (type >= witmotion::type_first && type <= witmotion::type_last) || type == witmotion::type_register;
}

bool is_packet_start(Bytes rest) {
  return rest[0] == witmotion::sync && is_known_type(rest[1]);
}

bool has_right_packet_sum(Bytes rest) {
  return wire::byte_sum8(rest.first(witmotion::sum_offset)) == rest[witmotion::sum_offset];
}

bool is_good(Bytes rest) {
  return is_packet_start(rest) && has_right_packet_sum(rest);
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
    reading.counts[axis] = wire::i16_at(rest, witmotion::words_offset + 2 * axis);
    reading.rate_dps[axis] = static_cast<float>(reading.counts[axis] * dps_per_count);
    reading.saturated |= is_at_range_end(reading.counts[axis]);
  }
  const std::int16_t temperature = wire::i16_at(rest, witmotion::words_offset + 2 * reading.counts.size());
  reading.temp_c = static_cast<float>(temperature / witmotion::temperature_counts_per_kelvin);
  return reading;
}

/// Finds WitMotion packets in a stream of bytes; gyro packets become readings, others are counted as replies.
/// At the start and after damage it takes two good packets in a row to lock, or one at the end of the stream,
/// because one byte of sum is weak and the sync byte is common inside packets.
class WitmotionScanner {
 public:
  void push(Bytes bytes, std::vector<GyroMessage>& out);
  /// The stream ends here: what only waits for the bytes behind it is decided.
  void finish(std::vector<GyroMessage>& out);
  void restart();
  const wire::Counters& counters() const { return ledger_.counters; }

 private:
  std::size_t step(Bytes rest, std::vector<GyroMessage>& out);
  std::size_t search(Bytes rest, std::vector<GyroMessage>& out);
  std::size_t take_packet(Bytes rest, std::vector<GyroMessage>& out);
  std::size_t skip(std::size_t bytes);

  wire::ByteLedger ledger_;
  std::vector<std::uint8_t> pending_;  // received, not yet booked
  bool locked_ = false;                // the packets before came in a row
  bool ended_ = false;
};

void WitmotionScanner::push(Bytes bytes, std::vector<GyroMessage>& out) {
  assert(!ended_);
  ledger_.receive(bytes.size());
  wire::reassemble(pending_, bytes, 2 * witmotion::packet_bytes, [&](Bytes rest) { return step(rest, out); });
  assert(pending_.size() == ledger_.waiting());
}

void WitmotionScanner::finish(std::vector<GyroMessage>& out) {
  ended_ = true;
  wire::reassemble_end(pending_, [&](Bytes rest) { return step(rest, out); });
  assert(pending_.size() == ledger_.waiting());
}

void WitmotionScanner::restart() {
  ledger_.restart();
  pending_.clear();
  locked_ = ended_ = false;
}

std::size_t WitmotionScanner::step(Bytes rest, std::vector<GyroMessage>& out) {
  if (rest[0] != witmotion::sync) return skip(wire::bytes_before(witmotion::sync, rest));
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

constexpr std::array<UsualBaud, 6> witmotion_bauds{
    {{115200, 0.15}, {9600, 0.11}, {230400, 0.06}, {38400, 0.06}, {460800, 0.04}, {921600, 0.04}}};

/// Packets of the gyro carry no time.
ClockProperties witmotion_clock(const GyroProfile&) {
  return {};
}

std::uint64_t witmotion_message_bytes(const GyroProfile&) {
  return witmotion::packet_bytes;
}

GyroScanner witmotion_scanner(const GyroProfile&, StreamStart) {
  return GyroScanner(WitmotionScanner());
}

std::optional<Evidence> recognise_witmotion(Bytes bytes, double) {
  WitmotionScanner scanner;
  std::vector<GyroMessage> messages;
  scanner.push(bytes, messages);
  if (messages.size() >= 2)
    return Evidence{.messages = messages.size(),
                    .bytes = scanner.counters().bytes_in_messages,
                    .text = fmt::format("{} WitMotion gyro packets", messages.size()),
                    .text_format = {}};
  constexpr std::uint64_t convincing_packets = 8;  // a packet's sum is weak, and few may be answers
  if (!messages.empty() || scanner.counters().replies < convincing_packets) return std::nullopt;
  return Evidence{
      .messages = 0,
      .bytes = scanner.counters().bytes_in_messages,
      .text = fmt::format("no rates of turn among {} good WitMotion packets", scanner.counters().replies),
      .text_format = {},
      .advice = "let it send its angular velocity (packet 52) too: the maker's tool, or register 02"};
}

/// It sends by itself, and is asked what its low-pass is set to.
std::vector<std::uint8_t> ask_for_bandwidth(const GyroProfile&, unsigned) {
  const auto& read = witmotion::read_register;
  return {read[0], read[1], read[2], witmotion::register_bandwidth, 0};
}

/// An answer does not name its register: this program asks for one alone.
std::optional<double> answered_bandwidth_hz(Bytes bytes) {
  for (; bytes.size() >= witmotion::packet_bytes; bytes = bytes.subspan(1)) {
    if (bytes[1] != witmotion::type_register || !is_good(bytes)) continue;
    if (!is_followed_well(bytes.subspan(witmotion::packet_bytes))) continue;
    const std::int16_t value = wire::i16_at(bytes, witmotion::words_offset);
    if (value < 0 || static_cast<std::size_t>(value) >= witmotion::bandwidths_hz.size()) return std::nullopt;
    return witmotion::bandwidths_hz[static_cast<std::size_t>(value)];
  }
  return std::nullopt;
}

}  // namespace

/// Of types that are not known, too: their sums are the same.
FramedProtocol witmotion_frames() {
  return {"WitMotion packets (55 5x)",
          [](Bytes rest) {
            constexpr std::uint8_t kind = 0xF0;
            const bool begins =
                rest[0] == witmotion::sync && (rest.size() == 1 || (rest[1] & kind) == witmotion::type_first);
            return begins ? std::optional(witmotion::packet_bytes) : std::nullopt;
          },
          has_right_packet_sum};
}

GyroProtocol witmotion_gyro() {
  return {.name = "witmotion",
          .sends = "WitMotion packets",
          .settings = {},
          .bauds = witmotion_bauds,
          .clock = witmotion_clock,
          .message_bytes = witmotion_message_bytes,
          .scanner = witmotion_scanner,
          .recognise = recognise_witmotion,
          .request = ask_for_bandwidth,
          .bandwidth_hz = answered_bandwidth_hz};
}

}  // namespace thermorig::sensors
