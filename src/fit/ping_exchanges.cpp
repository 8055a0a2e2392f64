// SPDX-License-Identifier: MIT
#include "ping_exchanges.h"

#include <algorithm>
#include <cstddef>

#include "thermorig/fit/clocks/recorded_clock.h"
#include "thermorig/pipeline/ping_ledger.h"

namespace thermorig::fit {

namespace {
/// The last telemetry before the message in the stream, or the first of all. There is one at least.
const TimedServo& telemetry_near(const std::vector<TimedServo>& servo, const StreamSpan& span) {
  const auto after = [](std::uint64_t begin, const TimedServo& state) { return begin < state.span.begin; };
  const auto next = std::upper_bound(servo.begin(), servo.end(), span.begin, after);
  return next == servo.begin() ? *next : *(next - 1);
}
}  // namespace

std::vector<timing::PingBound> ping_exchanges(const RawStream& received, const RawStream& sent,
                                              const pipeline::Streams& streams, std::uint32_t baud) {
  const auto spans = spans_of(streams.pongs);
  if (streams.servo.empty() || !holds(received, spans)) return {};
  const auto not_after = earliest_proofs(received, spans, baud);
  std::vector<timing::PingBound> exchanges;
  pipeline::PingLedger ledger(baud);
  std::size_t write = 0;
  for (std::size_t i = 0; i < spans.size(); ++i) {
    const TimedPong& pong = streams.pongs[i];
    for (; write < sent.chunk_count() && sent.time(write) <= pong.arrival; ++write)
      ledger.sent(sent.chunk(write), sent.time(write));
    const auto exchange = ledger.exchange(pong, telemetry_near(streams.servo, pong.span), not_after[i]);
    if (exchange) exchanges.push_back(*exchange);
  }
  return exchanges;
}

std::optional<double> shortest_round_trip_s(const std::vector<timing::PingBound>& exchanges) {
  std::optional<double> shortest_s;
  for (const timing::PingBound& exchange : exchanges) {
    // As floating point, which no two instants overflow.
    const double held_s =
        1e-6 * (static_cast<double>(exchange.send_us) - static_cast<double>(exchange.receive_us));
    const double away_s = 1e-9 * (static_cast<double>(to_ns(exchange.not_after)) -
                                  static_cast<double>(to_ns(exchange.not_before)));
    if (held_s < 0.0 || held_s > away_s) continue;  // no clock explains it
    shortest_s = std::min(shortest_s.value_or(away_s - held_s), away_s - held_s);
  }
  return shortest_s;
}

std::vector<timing::PingBound> sent_stamps(const RawStream& received, const std::vector<TimedServo>& servo,
                                           std::uint32_t baud) {
  const auto not_after = earliest_proofs(received, spans_of(servo), baud);
  std::vector<timing::PingBound> stamps;
  stamps.reserve(servo.size());
  for (std::size_t i = 0; i < servo.size(); ++i)
    stamps.push_back(timing::sent_at(servo[i].mcu_time_us, not_after[i]));
  return stamps;
}

std::vector<std::int64_t> mcu_times_us(const std::vector<TimedServo>& servo) {
  std::vector<std::int64_t> times_us;
  times_us.reserve(servo.size());
  for (const TimedServo& state : servo) times_us.push_back(state.mcu_time_us);
  return times_us;
}

}  // namespace thermorig::fit
