// SPDX-License-Identifier: MIT
#include "ripple_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "reached_speeds.h"
#include "thermorig/core/statistics.h"
#include "thermorig/pipeline/labels/pulse_train.h"
#include "thermorig/pipeline/labels/servo_model.h"

namespace thermorig::fit {

using labels::pulse_period_s, labels::ShaftSlope;

namespace {
constexpr double shortest_period_deg = 8.0;  // a pulse period at 200 deg/s passes half of it
constexpr double longest_period_deg = 540.0;
constexpr double least_periods = 2.0;       // passed from end to end
constexpr double most_span_deg = 10'800.0;  // 30 turns: the search takes time that grows with its square
constexpr double bin_deg = 1.0;
constexpr double least_power = 12.0;      // times the median: by chance one recording in ten thousand
constexpr double slowest_turn_dps = 3.0;  // below it a pulse period says little
constexpr double most_turns = 100'000.0;  // of a longer recording every second one, third ...
constexpr std::size_t least_turns = 500;

/// What the shaft turned within one pulse period.
struct Turn {
  double from_deg = 0.0, to_deg = 0.0;  // by the gain
  double off_deg = 0.0;                 // what the gyro saw beyond the fit

  double turned_deg() const { return to_deg - from_deg; }
};

double explained_deg(double from_deg, double to_deg, const std::vector<ServoResponse::Ripple>& ripples) {
  double sum_deg = 0.0;
  for (const ServoResponse::Ripple& ripple : ripples) {
    const RipplePhase from(from_deg, ripple.period_deg), to(to_deg, ripple.period_deg);
    const auto [cosine, sine] = ripple_turned_deg(from, to, ripple.period_deg);
    sum_deg += to_deg > from_deg ? ripple.forward_cosine * cosine + ripple.forward_sine * sine
                                 : ripple.backward_cosine * cosine + ripple.backward_sine * sine;
  }
  return sum_deg;
}

std::vector<Turn> turns_of(const ShaftEvidence& evidence, const GainFit& fit) {
  const ShaftSlope slope(fit.gain, {}, evidence.scale);
  std::size_t near_shaft = 0, near_gyro = 0;
  const auto gained_deg = [&](double time_s) {
    return slope.gained_deg(evidence.curve.angle_deg(time_s - evidence.delay_s, near_shaft));
  };
  // No more than there are samples to fill them: the times of a damaged recording may lie ages apart.
  const auto samples = static_cast<double>(evidence.gyro.times_s().size());
  const double count = std::clamp((evidence.end_s - evidence.begin_s) / pulse_period_s, 0.0, samples);
  const double step = std::max(1.0, std::ceil(count / most_turns));
  std::vector<Turn> turns;
  for (double i = 0.0; i + 1.0 < count; i += step) {
    const double from_s = evidence.begin_s + i * pulse_period_s, to_s = from_s + pulse_period_s;
    Turn turn{gained_deg(from_s), gained_deg(to_s), 0.0};
    if (std::abs(turn.turned_deg()) < slowest_turn_dps * pulse_period_s) continue;
    if (is_within(evidence.strayed, from_s)) continue;
    const double seen_dps =
        (evidence.gyro.mean_dps(from_s, to_s, near_gyro) - fit.bias_at(from_s)) / fit.ratio.value;
    turn.off_deg = seen_dps * pulse_period_s - turn.turned_deg() -
                   explained_deg(turn.from_deg, turn.to_deg, fit.ripples);
    if (std::isfinite(turn.off_deg)) turns.push_back(turn);
  }
  return turns;
}

/// Both directions, by the angle in their middle.
struct Bins {
  std::array<std::vector<double>, 2> products;  // of what was turned and what is off, a bin
  std::array<double, 2> squares{};              // of what was turned

  Bins(const std::vector<Turn>& turns, double low_deg, double high_deg) {
    const auto count = static_cast<std::size_t>((high_deg - low_deg) / bin_deg) + 1;
    for (std::vector<double>& one : products) one.assign(count, 0.0);
    for (const Turn& turn : turns) {
      const double middle_deg = (turn.from_deg + turn.to_deg) / 2.0;
      const auto bin = static_cast<std::size_t>((middle_deg - low_deg) / bin_deg);
      const std::size_t way = turn.to_deg > turn.from_deg ? 0 : 1;
      products[way][std::min(bin, count - 1)] += turn.turned_deg() * turn.off_deg;
      squares[way] += turn.turned_deg() * turn.turned_deg();
    }
  }

  /// How much of what is off a wave of so many periods a bin explains, up to a factor.
  double power(double frequency) const {
    double sum = 0.0;
    for (std::size_t way = 0; way < products.size(); ++way) {
      if (squares[way] == 0.0) continue;
      double cosine = 0.0, sine = 0.0, c = 1.0, s = 0.0;
      const double turn_c = std::cos(2.0 * std::numbers::pi * frequency);
      const double turn_s = std::sin(2.0 * std::numbers::pi * frequency);
      for (const double product : products[way]) {
        cosine += product * c;
        sine += product * s;
        const double next = c * turn_c - s * turn_s;  // the angle of the next bin
        s = s * turn_c + c * turn_s;
        c = next;
      }
      sum += (cosine * cosine + sine * sine) / squares[way];
    }
    return sum;
  }
};

/// Where the power about `frequency` is largest, within `step` of it.
double peak_of(const Bins& bins, double frequency, double step) {
  constexpr int halvings = 12;
  for (int i = 0; i < halvings; ++i) {
    step /= 2.0;
    for (const double to : {frequency - step, frequency + step})
      if (bins.power(to) > bins.power(frequency)) {
        frequency = to;
        break;
      }
  }
  return frequency;
}

bool is_known(double frequency, double resolution, const std::vector<ServoResponse::Ripple>& ripples) {
  return std::any_of(ripples.begin(), ripples.end(), [&](const ServoResponse::Ripple& ripple) {
    return std::abs(bin_deg / ripple.period_deg - frequency) < resolution;
  });
}

std::optional<double> strongest_period_deg(const Bins& bins,
                                           const std::vector<ServoResponse::Ripple>& known) {
  const double span_deg = bin_deg * static_cast<double>(bins.products[0].size());
  const double longest_deg = std::min(longest_period_deg, span_deg / least_periods);
  const double resolution = bin_deg / span_deg;
  std::vector<double> powers;
  double best = 0.0, best_power = 0.0;
  for (double at = bin_deg / longest_deg; at < bin_deg / shortest_period_deg; at += resolution / 2.0) {
    powers.push_back(bins.power(at));
    if (powers.back() <= best_power || is_known(at, resolution, known)) continue;
    best_power = powers.back();
    best = at;
  }
  if (powers.empty() || best_power < least_power * median(std::move(powers))) return std::nullopt;
  return bin_deg / peak_of(bins, best, resolution / 2.0);
}

}  // namespace

RipplePhase::RipplePhase(double angle_deg, double period_deg) {
  const double phase = 2.0 * std::numbers::pi / period_deg * angle_deg;
  cosine = std::cos(phase);
  sine = std::sin(phase);
}

std::array<double, 2> ripple_turned_deg(const RipplePhase& from, const RipplePhase& to, double period_deg) {
  const double wave = 2.0 * std::numbers::pi / period_deg;
  return {(to.sine - from.sine) / wave, (from.cosine - to.cosine) / wave};
}

std::optional<double> strongest_ripple_deg(const ShaftEvidence& evidence, const GainFit& fit) {
  if (evidence.scale.continuous()) return std::nullopt;
  const std::vector<Turn> turns = turns_of(evidence, fit);
  if (turns.size() < least_turns) return std::nullopt;
  double low_deg = turns.front().from_deg, high_deg = low_deg;
  for (const Turn& turn : turns) {
    low_deg = std::min({low_deg, turn.from_deg, turn.to_deg});
    high_deg = std::max({high_deg, turn.from_deg, turn.to_deg});
  }
  if (high_deg - low_deg > most_span_deg) return std::nullopt;
  return strongest_period_deg(Bins(turns, low_deg, high_deg), fit.ripples);
}

}  // namespace thermorig::fit
