// SPDX-License-Identifier: MIT
#include "loop_fit.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "least_squares.h"
#include "thermorig/core/statistics.h"

namespace thermorig::fit {

namespace {
constexpr double window_s = 0.02;       // one pulse period
constexpr double run_in_s = 0.8;        // the loop has forgotten how it started
constexpr double look_before_s = 0.05;  // of a change
constexpr double look_after_s = 0.45;
constexpr std::size_t most_changes = 100;
constexpr std::size_t coarse_changes = 16;
constexpr std::size_t least_changes = 3;
constexpr double least_share_followed = 0.9;  // of the gyro's variance
constexpr double typical_dead_band_deg = 0.3, dead_band_doubt_deg = 0.3;
constexpr double loop_doubt_of_log = 0.7;  // of its logarithm
constexpr double no_doubt = 1e-6;
constexpr double longest_delay_s = 0.15, earliest_delay_s = -0.05;
constexpr double slowest_hz = 1.0, fastest_hz = 40.0, widest_dead_band_deg = 2.0;
constexpr double least_residual_dps = 0.05;
constexpr double repeated = 8.0;  // samples that tell the same: windows overlap, and what a model lacks lasts
constexpr double outlying_change = 4.0;  // a hand on the rig: residual over that of most changes

struct Sample {
  double time_s;
  double rate_dps;
};

/// One change of speed: the pulses that shape it and what the gyro says of it.
struct Change {
  std::span<const PulseAt> pulses;
  double end_s = 0.0;
  std::vector<Sample> samples;
};

struct Parameters {
  double delay_s;
  double log_loop;
  double dead_band_deg;
  double loop_hz() const { return std::exp(log_loop); }
};

/// How well parameters do: the factor and the constant that fit best, and what is left.
struct Match {
  double factor = 0.0;
  double constant_dps = 0.0;
  double squares = 0.0;
  double share = 0.0;  // of the variance that is explained
};

std::span<const PulseAt> pulses_for(std::span<const PulseAt> pulses, double begin_s, double end_s) {
  const auto before = [](const PulseAt& pulse, double time) { return pulse.end_s < time; };
  const auto first = std::lower_bound(pulses.begin(), pulses.end(), begin_s, before);
  const auto last = std::lower_bound(first, pulses.end(), end_s, before);
  const auto from = first == pulses.begin() ? first : first - 1;
  return {from, last};
}

std::vector<Sample> samples_of(const GyroIntegral& gyro, double begin_s, double end_s) {
  std::vector<Sample> samples;
  std::size_t near = 0;
  const auto& times = gyro.times_s();
  for (auto time = std::lower_bound(times.begin(), times.end(), begin_s);
       time != times.end() && *time < end_s; ++time) {
    const double rate_dps = gyro.mean_dps(*time - window_s / 2.0, *time + window_s / 2.0, near);
    if (std::isfinite(rate_dps)) samples.push_back({*time, rate_dps});
  }
  return samples;
}

std::vector<Change> prepare(std::span<const PulseAt> pulses, std::span<const Interval> changes,
                            const GyroIntegral& gyro, std::size_t most) {
  std::vector<Change> prepared;
  const std::size_t stride = std::max<std::size_t>((changes.size() + most - 1) / most, 1);
  for (std::size_t i = 0; i < changes.size(); i += stride) {
    Change change;
    const double length_s = std::min(changes[i].end_s - changes[i].begin_s, 1.0);
    change.end_s = changes[i].begin_s + length_s + look_after_s;
    change.pulses = pulses_for(pulses, changes[i].begin_s - run_in_s, change.end_s + longest_delay_s);
    change.samples = samples_of(gyro, changes[i].begin_s - look_before_s, change.end_s);
    if (!change.pulses.empty() && !change.samples.empty()) prepared.push_back(std::move(change));
  }
  return prepared;
}

class Problem {
 public:
  Problem(std::vector<Change> changes, double filter_delay_s, const ServoProfile& profile, bool has_loop)
      : changes_(std::move(changes)),
        low_pass_(filter_delay_s),
        has_dead_band_(profile.kind != ServoKind::continuous && has_loop),
        continuous_(profile.kind == ServoKind::continuous),
        log_loop_(std::log(has_loop ? std::clamp(profile.loop_hz, slowest_hz, fastest_hz) : fastest_hz)),
        loop_doubt_(has_loop ? loop_doubt_of_log : no_doubt) {
    for (const Change& change : changes_)
      for (const Sample& sample : change.samples) measured_.push_back(sample.rate_dps);
  }

  std::size_t changes() const { return changes_.size(); }
  std::size_t samples() const { return measured_.size(); }

  /// What the model makes of all changes, and its mean rates at all samples.
  struct Prediction {
    std::vector<ShaftCurve> curves;
    std::vector<double> rates;
  };
  Prediction predict(const Parameters& p) const {
    Prediction predicted{curves_of(p.loop_hz(), p.dead_band_deg), {}};
    predicted.rates = means(predicted.curves, p.delay_s);
    return predicted;
  }

  Match match(const std::vector<double>& rates) const {
    LineFit line;
    for (std::size_t i = 0; i < rates.size(); ++i) line.add(rates[i], measured_[i]);
    const double squares = line.residual_squares(), total = line.squares_y();
    return {line.slope(), line.at(0.0), squares, total > 0.0 ? 1.0 - squares / total : 0.0};
  }

  /// The delay of a grid that matches best, for a bandwidth.
  std::pair<Parameters, double> best_delay(double loop_hz) const {
    constexpr double step_s = 0.005;
    const std::vector<ShaftCurve> curves = curves_of(loop_hz, dead_band_deg());
    std::pair<Parameters, double> best{{0.0, std::log(loop_hz), dead_band_deg()}, -1.0};
    for (double delay_s = earliest_delay_s; delay_s < longest_delay_s; delay_s += step_s) {
      const Match found = match(means(curves, delay_s));
      if (best.second >= 0.0 && found.squares >= best.second) continue;
      best = {{delay_s, std::log(loop_hz), dead_band_deg()}, found.squares};
    }
    return best;
  }

  /// One Gauss-Newton step with damping from `p`, which makes `predicted`; the uncertainty of the delay comes
  /// with it.
  struct Step {
    Parameters to;
    double delay_uncertainty_s;
  };
  Step step(const Parameters& p, const Prediction& predicted, double damping) const;

  /// Drops the changes that the model explains much worse than most.
  bool drop_outliers(const Parameters& p);

  double dead_band_deg() const { return has_dead_band_ ? typical_dead_band_deg : 0.0; }
  double penalty(const Parameters& p) const {
    const double loop = (p.log_loop - log_loop_) / loop_doubt_;
    const double band = (p.dead_band_deg - dead_band_deg()) / dead_band_doubt_deg;
    return loop * loop + band * band;
  }
  double cost(const Parameters& p, double squares) const {
    const double deviation = residual_dps_;
    return squares / (repeated * deviation * deviation) + penalty(p);
  }
  void set_residual(double residual_dps) { residual_dps_ = std::max(residual_dps, least_residual_dps); }

 private:
  std::vector<ShaftCurve> curves_of(double loop_hz, double dead_band_deg) const {
    std::vector<ShaftCurve> curves;
    curves.reserve(changes_.size());
    for (const Change& change : changes_)
      curves.emplace_back(change.pulses, continuous_, loop_hz, dead_band_deg, change.end_s + longest_delay_s);
    return curves;
  }
  std::vector<double> means(const std::vector<ShaftCurve>& curves, double delay_s) const {
    std::vector<double> rates;
    rates.reserve(measured_.size());
    for (std::size_t i = 0; i < changes_.size(); ++i) {
      ShaftCurve::Near near;
      for (const Sample& sample : changes_[i].samples)
        rates.push_back(shown_dps(curves[i], sample.time_s - delay_s, near));
    }
    return rates;
  }

  /// What the gyro shows of the curve around a time. `near`: see ShaftCurve::mean_dps().
  double shown_dps(const ShaftCurve& curve, double at_s, ShaftCurve::Near& near) const {
    const auto mean = [&](double begin_s, double end_s) { return curve.mean_dps(begin_s, end_s, near); };
    return low_pass_.shown_dps(at_s - window_s / 2.0, at_s + window_s / 2.0, mean);
  }

  std::vector<Change> changes_;
  LowPass low_pass_;
  std::vector<double> measured_;
  bool has_dead_band_;
  bool continuous_;
  double log_loop_, loop_doubt_;
  double residual_dps_ = 1.0;
};

Problem::Step Problem::step(const Parameters& p, const Prediction& predicted, double damping) const {
  constexpr double delay_step_s = 2e-4, log_step = 0.02, band_step_deg = 0.02;
  const std::vector<double>& now = predicted.rates;
  const std::vector<double> later = means(predicted.curves, p.delay_s + delay_step_s);
  const std::vector<double> stiffer = predict({p.delay_s, p.log_loop + log_step, p.dead_band_deg}).rates;
  const std::vector<double> wider = predict({p.delay_s, p.log_loop, p.dead_band_deg + band_step_deg}).rates;
  const Match found = match(now);
  const double deviation = residual_dps_ * std::sqrt(repeated);
  LeastSquares equations(5);
  for (std::size_t i = 0; i < now.size(); ++i) {
    const std::array<double, 5> row{found.factor * (later[i] - now[i]) / delay_step_s,
                                    found.factor * (stiffer[i] - now[i]) / log_step,
                                    found.factor * (wider[i] - now[i]) / band_step_deg, now[i], 1.0};
    equations.add(row, measured_[i] - found.factor * now[i] - found.constant_dps, deviation);
  }
  equations.add_prior(0, 0.0, longest_delay_s / damping);
  equations.add_prior(1, log_loop_ - p.log_loop, loop_doubt_);
  equations.add_prior(2, dead_band_deg() - p.dead_band_deg, has_dead_band_ ? dead_band_doubt_deg : no_doubt);
  equations.add_prior(1, 0.0, 1.0 / damping);
  equations.add_prior(2, 0.0, 1.0 / damping);
  equations.add_prior(3, 0.0, 10.0);
  equations.add_prior(4, 0.0, 1000.0);
  const std::vector<double> change = equations.solve();
  const std::array<double, 5> delay_alone{1.0, 0.0, 0.0, 0.0, 0.0};
  return {{std::clamp(p.delay_s + change[0], earliest_delay_s, longest_delay_s),
           std::clamp(p.log_loop + change[1], std::log(slowest_hz), std::log(fastest_hz)),
           has_dead_band_ ? std::clamp(p.dead_band_deg + change[2], 0.0, widest_dead_band_deg) : 0.0},
          std::sqrt(equations.variance(delay_alone))};
}

bool Problem::drop_outliers(const Parameters& p) {
  const std::vector<double> rates = predict(p).rates;
  const Match found = match(rates);
  std::vector<double> residuals;
  std::size_t at = 0;
  for (const Change& change : changes_) {
    double squares = 0.0;
    for (std::size_t i = 0; i < change.samples.size(); ++i, ++at) {
      const double off = measured_[at] - found.factor * rates[at] - found.constant_dps;
      squares += off * off;
    }
    residuals.push_back(std::sqrt(squares / static_cast<double>(change.samples.size())));
  }
  const double limit = outlying_change * std::max(median(residuals), least_residual_dps);
  std::vector<Change> kept;
  for (std::size_t i = 0; i < changes_.size(); ++i)
    if (residuals[i] <= limit) kept.push_back(std::move(changes_[i]));
  const bool dropped = kept.size() < changes_.size();
  changes_ = std::move(kept);
  measured_.clear();
  for (const Change& change : changes_)
    for (const Sample& sample : change.samples) measured_.push_back(sample.rate_dps);
  return dropped;
}

double loop_residual_dps(const Problem& problem, double squares) {
  return std::sqrt(squares / static_cast<double>(problem.samples()));
}

/// Levenberg-Marquardt from the best point of a coarse grid.
Parameters descend(Problem& problem, Parameters p) {
  constexpr int rounds = 12;
  constexpr double enough = 1e-5;
  double damping = 1.0;
  Problem::Prediction now = problem.predict(p);
  double squares = problem.match(now.rates).squares;
  problem.set_residual(loop_residual_dps(problem, squares));
  double cost = problem.cost(p, squares);
  for (int i = 0; i < rounds; ++i) {
    const Parameters next = problem.step(p, now, damping).to;
    Problem::Prediction then = problem.predict(next);
    squares = problem.match(then.rates).squares;
    const double next_cost = problem.cost(next, squares);
    if (!(next_cost < cost)) {
      damping *= 8.0;
      continue;
    }
    const bool done = cost - next_cost < enough * cost;
    damping /= 4.0;
    p = next;
    now = std::move(then);
    problem.set_residual(loop_residual_dps(problem, squares));
    cost = problem.cost(p, squares);
    if (done) break;
  }
  return p;
}

Parameters coarse(const Problem& problem, bool has_loop) {
  constexpr std::array tried_hz{3.0, 5.0, 8.0, 12.0, 18.0, 27.0, fastest_hz};
  std::pair<Parameters, double> best{{}, -1.0};
  const std::span all(tried_hz);
  for (const double loop_hz : has_loop ? all.first(all.size() - 1) : all.last(1)) {
    const auto found = problem.best_delay(loop_hz);
    if (best.second < 0.0 || found.second < best.second) best = found;
  }
  return best.first;
}
}  // namespace

std::optional<LoopFit> fit_loop(std::span<const PulseAt> pulses, std::span<const Interval> changes,
                                const GyroIntegral& gyro, double filter_delay_s, const ServoProfile& profile,
                                bool has_loop) {
  const auto problem_of = [&](std::size_t most) {
    return Problem(prepare(pulses, changes, gyro, most), filter_delay_s, profile, has_loop);
  };
  Problem problem = problem_of(most_changes);
  if (problem.changes() < least_changes) return std::nullopt;
  Parameters p = descend(problem, coarse(problem_of(coarse_changes), has_loop));
  if (problem.drop_outliers(p) && problem.changes() >= least_changes) p = descend(problem, p);
  if (problem.changes() < least_changes) return std::nullopt;
  const Problem::Prediction predicted = problem.predict(p);
  const Match found = problem.match(predicted.rates);
  if (found.share < least_share_followed || found.factor <= 0.0) return std::nullopt;
  const double uncertainty_s = problem.step(p, predicted, 1e-3).delay_uncertainty_s;
  return LoopFit{
      {p.delay_s, uncertainty_s}, p.loop_hz(), p.dead_band_deg, loop_residual_dps(problem, found.squares)};
}

}  // namespace thermorig::fit
