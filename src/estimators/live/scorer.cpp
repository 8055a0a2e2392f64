// SPDX-License-Identifier: MIT
#include "thermorig/estimators/live/scores.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>
#include <vector>

#include "thermorig/core/statistics.h"
#include "thermorig/estimators/errors.h"
#include "thermorig/estimators/live/finalised_rows.h"
#include "thermorig/network/gate.h"

namespace thermorig::live {

namespace {

/// Squared errors of the last minute, in order of time and in order of size.
class RecentErrors {
 public:
  void add(HostTime time, double squared);

  /// Forgets what is a minute or more before `now`.
  void forget_before(HostTime now);

  const std::vector<double>& sorted() const { return sorted_; }

 private:
  struct Entry {
    HostTime time{};
    double squared = 0.0;
  };
  void forget_oldest();

  std::deque<Entry> entries_;
  std::vector<double> sorted_;
};

constexpr double minute_s = 60.0;
constexpr std::size_t most_entries = 60'000;  // 1000 frames/s: only a file whose times stand still has more

void RecentErrors::add(HostTime time, double squared) {
  if (entries_.size() == most_entries) forget_oldest();
  entries_.push_back({time, squared});
  sorted_.insert(std::upper_bound(sorted_.begin(), sorted_.end(), squared), squared);
}

void RecentErrors::forget_before(HostTime now) {
  while (!entries_.empty() && seconds_between(entries_.front().time, now) >= minute_s) forget_oldest();
}

void RecentErrors::forget_oldest() {
  sorted_.erase(std::lower_bound(sorted_.begin(), sorted_.end(), entries_.front().squared));
  entries_.pop_front();
}

constexpr double drift_after_s = 1.0;
constexpr std::uint64_t gate_patience = 64;  // counted frames

/// Of one estimator.
struct EstimatorSums {
  std::string name;
  estimators::RateErrors errors;
  RecentErrors recent;  // normalised
  estimators::AngleError angle;

  void add(HostTime time, double error_dps, double step_s, double label_scale_dps) {
    errors.add(error_dps);
    recent.add(time, error_dps * error_dps / (label_scale_dps * label_scale_dps));
    angle.add(error_dps, step_s);
  }

  EstimatorScores scores(double label_scale_dps) const;
};

EstimatorScores EstimatorSums::scores(double label_scale_dps) const {
  const std::vector<double>& sorted = recent.sorted();
  return {.name = name,
          .frames = errors.count(),
          .mse = errors.mse(label_scale_dps),
          .rmse_dps = errors.rmse_dps(),
          .recent = sorted.size(),
          .recent_median_mse = quantile(sorted, 0.5),
          .recent_iqr_mse = quantile(sorted, 0.75) - quantile(sorted, 0.25),
          .angle_error_deg = errors.count() > 0 ? angle.angle_deg() : unknown,
          .drift_deg_per_min = angle.integrated_s() < drift_after_s ? unknown : angle.drift_deg_per_min()};
}

/// Gains of the counted frames.
struct GainSums {
  std::array<std::uint64_t, network::gain_bins> histogram{};
  std::uint64_t frames = 0;
  double sum = 0.0;
  std::uint64_t closed = 0, open = 0;  // how many of the last in a row

  void add(double gain) {
    ++histogram[network::gain_bin(gain)];
    ++frames;
    sum += gain;
    closed = gain < network::closed_gate ? closed + 1 : 0;
    open = gain > network::open_gate ? open + 1 : 0;
  }

  double mean() const { return frames > 0 ? sum / static_cast<double>(frames) : unknown; }
  bool collapsed() const { return closed >= gate_patience || open >= gate_patience; }
};

/// The last row, as far as the next one's step needs it.
struct Before {
  std::uint32_t frame_index = 0;
  std::uint32_t run = 0;
  HostTime time{};
};

/// A counted window stands for the time since the frame before, if that is of the same run.
double step_of(const std::optional<Before>& before, const EstimateRow& row) {
  if (!before || before->run != row.run || before->frame_index + 1 != row.frame_index) return 0.0;
  return std::max(0.0, seconds_between(before->time, row.time));
}

}  // namespace

std::optional<float> gain_of(std::span<const EstimatorColumn> estimators, const EstimateRow& row) {
  for (std::size_t i = 0; i < estimators.size(); ++i)
    for (std::size_t k = 0; k < estimators[i].values.size(); ++k)
      if (estimators[i].values[k] == "gain") return row.estimates[i].values[k];
  return std::nullopt;
}

struct Scorer::Parts {
  double label_scale_dps;
  std::uint64_t frames = 0, counted = 0;
  double integrated_s = 0.0;
  std::vector<EstimatorColumn> columns;
  std::vector<EstimatorSums> estimators;
  GainSums gains;
  std::optional<Before> before;

  void count(const EstimateRow& row, double step_s);
};

void Scorer::Parts::count(const EstimateRow& row, double step_s) {
  ++counted;
  integrated_s += step_s;
  for (std::size_t i = 0; i < estimators.size(); ++i) {
    const double error_dps =
        static_cast<double>(row.estimates[i].rate_dps) - static_cast<double>(row.rate_commanded_dps);
    if (std::isfinite(error_dps)) estimators[i].add(row.time, error_dps, step_s, label_scale_dps);
  }
  const std::optional<float> gain = gain_of(columns, row);
  if (gain && *gain >= 0.0F && *gain <= 1.0F) gains.add(*gain);
}

Scorer::Scorer(std::span<const EstimatorColumn> estimators, double label_scale_dps)
    : parts_(std::make_unique<Parts>(Parts{label_scale_dps})) {
  parts_->columns.assign(estimators.begin(), estimators.end());
  for (const EstimatorColumn& column : estimators) parts_->estimators.push_back({.name = column.name});
}

Scorer::~Scorer() = default;
Scorer::Scorer(Scorer&&) noexcept = default;
Scorer& Scorer::operator=(Scorer&&) noexcept = default;

void Scorer::add(const EstimateRow& row) {
  Parts& parts = *parts_;
  ++parts.frames;
  for (EstimatorSums& sums : parts.estimators) sums.recent.forget_before(row.time);
  if (row.counted) parts.count(row, step_of(parts.before, row));
  parts.before = Before{row.frame_index, row.run, row.time};
}

LiveScores Scorer::scores() const {
  const Parts& parts = *parts_;
  LiveScores scores{.frames = parts.frames,
                    .counted = parts.counted,
                    .excluded = parts.frames - parts.counted,
                    .integrated_s = parts.integrated_s,
                    .gain_histogram = parts.gains.histogram,
                    .gain_mean = parts.gains.mean(),
                    .gate_collapsed = parts.gains.collapsed()};
  for (const EstimatorSums& sums : parts.estimators)
    scores.estimators.push_back(sums.scores(parts.label_scale_dps));
  return scores;
}

}  // namespace thermorig::live
