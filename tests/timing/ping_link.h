// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <random>
#include <vector>

#include "thermorig/core/profile.h"
#include "thermorig/pipeline/timing/ping_clock.h"

namespace thermorig::timing {

/// A servo's clock that wanders as a quartz does: tens of ppm off, 5 ppm with the room, and a random walk.
class QuartzClock {
 public:
  QuartzClock(std::uint64_t seed, double duration_s) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    const double mean = 30e-6 * normal(random);
    const double phase_rad = normal(random);
    double walked = 0.0;
    double offset_s = 0.0;
    for (double at_s = 0.0; at_s < duration_s + 2.0; at_s += 1.0) {
      offsets_s_.push_back(offset_s);
      offset_s += mean + 5e-6 * std::sin(2.0 * std::numbers::pi * at_s / 300.0 + phase_rad) + walked;
      walked += 0.1e-6 * normal(random) - walked / 600.0;
    }
  }

  /// Host time at which the clock shows `mcu_s`.
  double host_s(double mcu_s) const {
    const auto second = static_cast<std::size_t>(mcu_s);
    const double part = mcu_s - static_cast<double>(second);
    return mcu_s + offsets_s_[second] + part * (offsets_s_[second + 1] - offsets_s_[second]);
  }
  double mcu_s(double host_at_s) const {
    double at_s = host_at_s;
    for (int i = 0; i < 4; ++i) at_s = host_at_s - (host_s(at_s) - at_s);
    return at_s;
  }

 private:
  std::vector<double> offsets_s_;  // host minus micro-controller, at each second
};

/// The host's clock where it is slewed by `slew` for two minutes in four, as NTP may.
inline double slewed_s(double at_s, double slew) {
  const double cycles = std::floor(at_s / 240.0);
  return at_s + slew * (120.0 * cycles + std::min(at_s - 240.0 * cycles, 120.0));
}

struct LinkOptions {
  std::uint64_t seed = 1;
  double duration_s = 100.0;
  double ping_s = 0.1;
  double latency_timer_s = 0.0;  // 0: none, as with CDC
  double dither_s = 0.003;
  double wire_error_s = 0.0;  // wire times are taken for so much longer than they are
};

/// What went over a USB link to a servo and back: 1 ms frames, wake-ups of 50 us and more, now and then late.
struct PingTraffic {
  QuartzClock clock;
  std::vector<std::int64_t> mcu_us;
  std::vector<PingBound> exchanges;
  std::vector<PingBound> sent;
};

inline PingTraffic traffic(const LinkOptions& options) {
  PingTraffic result{QuartzClock(options.seed, options.duration_s + 1.0), {}, {}, {}};
  std::mt19937_64 random(options.seed + 1000);
  std::uniform_real_distribution<double> uniform;
  std::exponential_distribution<double> tail(1.0 / 80e-6);
  const double frame_s = 1e-3 * (1.0 + 40e-6 * (uniform(random) - 0.5));
  const double frame_phase_s = 1e-3 * uniform(random);
  const double tick_phase_s = options.latency_timer_s * uniform(random);
  const auto next = [](double at_s, double phase_s, double period_s) {
    return phase_s + std::ceil((at_s - phase_s) / period_s) * period_s;
  };
  const auto arrival_s = [&](double sent_s) {
    if (options.latency_timer_s > 0.0) sent_s = next(sent_s, tick_phase_s, options.latency_timer_s);
    double late_s = 50e-6 + tail(random);
    if (uniform(random) < 0.01) late_s += 0.020 * uniform(random);
    return next(sent_s, frame_phase_s, frame_s) + late_s;
  };
  const auto host = [](double at_s) { return HostTime(from_s(at_s)); };
  for (double mcu_s = 0.5; mcu_s < options.duration_s; mcu_s += 0.01) {
    const std::int64_t mcu_us = std::llround(mcu_s * 1e6);
    result.mcu_us.push_back(mcu_us);
    result.sent.push_back(
        sent_at(mcu_us, host(arrival_s(result.clock.host_s(mcu_s) + 30e-6) - options.wire_error_s)));
  }
  for (double at_s = 1.0; at_s < options.duration_s - 1.0;
       at_s += options.ping_s * (0.7 + 0.6 * uniform(random))) {
    const double received_s = result.clock.mcu_s(next(at_s, frame_phase_s, frame_s));
    const double sent_s = received_s + options.dither_s * uniform(random);
    const auto ticks_us = [](double mcu_s) { return 4 * static_cast<std::int64_t>(mcu_s * 1e6 / 4.0); };
    result.exchanges.push_back({ticks_us(received_s), host(at_s + options.wire_error_s), ticks_us(sent_s),
                                host(arrival_s(result.clock.host_s(sent_s)) - options.wire_error_s)});
  }
  return result;
}

/// Feeds a causal clock in the order of arrival; `look` sees it after each telemetry message.
template <typename Look>
void feed(PingClock& clock, const PingTraffic& traffic, Look look) {
  std::size_t next = 0;
  for (const PingBound& stamp : traffic.sent) {
    for (; next < traffic.exchanges.size() && traffic.exchanges[next].not_after <= stamp.not_after; ++next)
      clock.feed(traffic.exchanges[next]);
    clock.feed(stamp);
    look(stamp.send_us);
  }
}

inline PortProfile servo_link() {
  return ServoProfile{}.link;
}

struct ServoScore {
  double p99_s = 0.0;
  double widest_s = 0.0;
  int violations = 0;
};

/// Errors and bounds of `times` from `from_s` on.
inline ServoScore judge(const std::vector<std::int64_t>& mcu_us, const std::vector<TimeEstimate>& times,
                        const QuartzClock& clock, double from_s) {
  std::vector<double> errors_s;
  ServoScore score;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const double mcu_s = 1e-6 * static_cast<double>(mcu_us[i]);
    if (mcu_s < from_s) continue;
    const double late_s = 1e-9 * static_cast<double>(to_ns(times[i].time)) - clock.host_s(mcu_s);
    errors_s.push_back(std::abs(late_s));
    score.widest_s = std::max(score.widest_s, static_cast<double>(times[i].earlier_s + times[i].later_s));
    score.violations += late_s > static_cast<double>(times[i].earlier_s) + 2e-9 ||
                        -late_s > static_cast<double>(times[i].later_s) + 2e-9;
  }
  std::sort(errors_s.begin(), errors_s.end());
  score.p99_s = errors_s.empty() ? 1.0 : errors_s[errors_s.size() * 99 / 100];
  return score;
}

/// Everything of a second recording after a first one, its host times shifted by `host_shift_s` and its
/// micro-controller's by `mcu_shift_us`.
inline void append(PingTraffic& to, const PingTraffic& more, double host_shift_s, std::int64_t mcu_shift_us) {
  const HostDuration host_shift = from_s(host_shift_s);
  for (const std::int64_t mcu_us : more.mcu_us) to.mcu_us.push_back(mcu_us + mcu_shift_us);
  for (const PingBound& stamp : more.sent)
    to.sent.push_back(sent_at(stamp.send_us + mcu_shift_us, stamp.not_after + host_shift));
  for (const PingBound& exchange : more.exchanges)
    to.exchanges.push_back({exchange.receive_us + mcu_shift_us, exchange.not_before + host_shift,
                            exchange.send_us + mcu_shift_us, exchange.not_after + host_shift});
}

/// The same traffic on a host whose clock runs off by `ahead_s`(time) from the true one.
template <typename Ahead>
PingTraffic on_host(PingTraffic traffic, Ahead ahead_s) {
  const auto shown = [&](HostTime time) { return time + from_s(ahead_s(to_s(time.time_since_epoch()))); };
  for (PingBound& stamp : traffic.sent) stamp.not_after = shown(stamp.not_after);
  for (PingBound& exchange : traffic.exchanges) {
    exchange.not_before = shown(exchange.not_before);
    exchange.not_after = shown(exchange.not_after);
  }
  return traffic;
}

/// Clocks against which the micro-controller's wanders far more than a quartz does: the host's is slewed for
/// two minutes in four, or the micro-controller has a resonator that warms up, or one in a draught.
struct Wandering {
  const char* name;
  double (*ahead_s)(double at_s);
};

inline const std::array<Wandering, 5> wandering{{
    {"slewed forward", [](double at_s) { return slewed_s(at_s, 500e-6) - at_s; }},
    {"slewed back", [](double at_s) { return slewed_s(at_s, -500e-6) - at_s; }},
    {"warms up", [](double at_s) { return 300e-6 * 120.0 * (1.0 - std::exp(-at_s / 120.0)); }},
    {"cools down", [](double at_s) { return -300e-6 * 120.0 * (1.0 - std::exp(-at_s / 120.0)); }},
    {"waves", [](double at_s) { return 40e-6 * 60.0 / 6.283 * std::sin(6.283 * at_s / 60.0); }},
}};

/// Violations of the bounds, by the host's own clock.
inline int violations_on(const std::vector<std::int64_t>& mcu_us, const std::vector<TimeEstimate>& times,
                         const QuartzClock& clock, double (*ahead_s)(double)) {
  int violations = 0;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const double true_s = clock.host_s(1e-6 * static_cast<double>(mcu_us[i]));
    const double late_s = to_s(times[i].time.time_since_epoch()) - true_s - ahead_s(true_s);
    violations += late_s > static_cast<double>(times[i].earlier_s) + 2e-9 ||
                  -late_s > static_cast<double>(times[i].later_s) + 2e-9;
  }
  return violations;
}

/// Ten minutes of it, behind a latency timer or none.
inline PingTraffic wild_traffic(const Wandering& one, double timer_s) {
  const LinkOptions options{
      .seed = 14, .duration_s = 600.0, .latency_timer_s = timer_s, .dither_s = timer_s > 0.0 ? 0.020 : 0.003};
  return on_host(traffic(options), one.ahead_s);
}

/// Messages with every pair of values that breaks a sum.
struct HostileTraffic {
  std::vector<std::int64_t> values;
  std::vector<PingBound> exchanges;
  std::vector<PingBound> sent;
};

inline HostileTraffic hostile_traffic() {
  constexpr std::int64_t least = std::numeric_limits<std::int64_t>::min();
  constexpr std::int64_t most = std::numeric_limits<std::int64_t>::max();
  HostileTraffic hostile{{least, most, 0, -1, 4'294'967'295, least, 1, most, most}, {}, {}};
  for (const std::int64_t a : hostile.values)
    for (const std::int64_t b : hostile.values) {
      hostile.exchanges.push_back({a, host_time_ns(b), b, host_time_ns(a)});
      hostile.sent.push_back(sent_at(a, host_time_ns(b)));
    }
  return hostile;
}

}  // namespace thermorig::timing
