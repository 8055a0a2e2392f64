// SPDX-License-Identifier: MIT
#include "gain_statistics.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "thermorig/core/estimate.h"
#include "thermorig/core/statistics.h"
#include "thermorig/learning/training/fit.h"
#include "thermorig/network/gate.h"

namespace thermorig::study {

namespace {

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double deviation_of(const std::vector<double>& values, double mean) {
  double squares = 0.0;
  for (const double value : values) squares += (value - mean) * (value - mean);
  return std::sqrt(squares / static_cast<double>(values.size()));
}

std::vector<double> sorted_gains(std::span<const JudgedWindow> judged) {
  std::vector<double> gains;
  for (const JudgedWindow& one : judged)
    if (std::isfinite(one.gain)) gains.push_back(one.gain);
  std::sort(gains.begin(), gains.end());
  return gains;
}

/// Where half of the values lie below, as if those of a bin, or of the part beyond where a gate counts as
/// closed or open, were spread evenly over it. The parts come first: a collapsed gate lies deep in a bin.
double median_by_counts(const GainStatistics& statistics) {
  if (statistics.below_002 >= 0.5) return 0.5 * network::closed_gate / statistics.below_002;
  if (statistics.above_098 >= 0.5) return 1.0 - 0.5 * (1.0 - network::open_gate) / statistics.above_098;
  const double half = static_cast<double>(statistics.windows()) / 2.0;
  double below = 0.0;
  for (std::size_t bin = 0; bin < GainStatistics::bins; ++bin) {
    const double count = static_cast<double>(statistics.histogram[bin]);
    if (count > 0.0 && below + count >= half)
      return (static_cast<double>(bin) + (half - below) / count) / static_cast<double>(GainStatistics::bins);
    below += count;
  }
  return unknown;
}

/// Sums over parts, weighed by their windows.
struct GainSums {
  double windows = 0.0, gains = 0.0, squares = 0.0, below = 0.0, above = 0.0;

  void add(const GainStatistics& part) {
    const double count = static_cast<double>(part.windows());
    windows += count;
    gains += count * part.mean;
    squares += count * (part.deviation * part.deviation + part.mean * part.mean);
    below += count * part.below_002;
    above += count * part.above_098;
  }
};

}  // namespace

std::uint64_t GainStatistics::windows() const {
  return std::accumulate(histogram.begin(), histogram.end(), std::uint64_t{0});
}

bool collapsed(const GainStatistics& gain) {
  return gain.windows() > 0 && training::gate_collapsed(gain.mean);
}

GainStatistics gain_statistics(std::span<const JudgedWindow> judged) {
  const std::vector<double> gains = sorted_gains(judged);
  GainStatistics statistics;
  if (gains.empty()) return statistics;
  for (const double gain : gains) ++statistics.histogram[network::gain_bin(gain)];
  statistics.mean = mean_of(gains);
  statistics.deviation = deviation_of(gains, statistics.mean);
  statistics.median = quantile(gains, 0.5);
  const auto low = std::lower_bound(gains.begin(), gains.end(), network::closed_gate);
  const auto high = std::upper_bound(gains.begin(), gains.end(), network::open_gate);
  const double count = static_cast<double>(gains.size());
  statistics.below_002 = static_cast<double>(low - gains.begin()) / count;
  statistics.above_098 = static_cast<double>(gains.end() - high) / count;
  return statistics;
}

GainStatistics merged(std::span<const GainStatistics> parts) {
  GainStatistics all;
  GainSums sums;
  for (const GainStatistics& part : parts) {
    if (part.windows() == 0) continue;
    for (std::size_t bin = 0; bin < GainStatistics::bins; ++bin) all.histogram[bin] += part.histogram[bin];
    sums.add(part);
  }
  if (sums.windows == 0.0) return all;
  all.mean = sums.gains / sums.windows;
  all.deviation = std::sqrt(std::max(0.0, sums.squares / sums.windows - all.mean * all.mean));
  all.below_002 = sums.below / sums.windows;
  all.above_098 = sums.above / sums.windows;
  all.median = median_by_counts(all);
  return all;
}

std::optional<GateSigma> gate_sigma(std::span<const JudgedWindow> judged) {
  std::vector<double> sigmas, gains;
  double within_one = 0.0, within_two = 0.0, squares = 0.0;
  for (const JudgedWindow& one : judged) {
    const double error_dps = double{one.rate_dps[thermal_name]} - double{one.shaft_dps}, gain = one.gain;
    if (!std::isfinite(one.sigma_dps) || !std::isfinite(error_dps)) continue;
    const double in_sigmas = std::abs(error_dps) / double{one.sigma_dps};
    within_one += in_sigmas <= 1.0 ? 1.0 : 0.0;
    within_two += in_sigmas <= 2.0 ? 1.0 : 0.0;
    const double of_images = gain * error_dps, of_gyro = (1.0 - gain) * expected_gyro_dps;
    squares += of_images * of_images + of_gyro * of_gyro;
    sigmas.push_back(double{one.sigma_dps});
    gains.push_back(gain);
  }
  if (sigmas.empty()) return std::nullopt;
  std::sort(sigmas.begin(), sigmas.end());
  std::sort(gains.begin(), gains.end());
  const auto count = static_cast<double>(sigmas.size());
  return GateSigma{.windows = sigmas.size(),
                   .median_dps = quantile(sigmas, 0.5),
                   .within_one = within_one / count,
                   .within_two = within_two / count,
                   .gain_p05 = quantile(gains, 0.05),
                   .gain_p95 = quantile(gains, 0.95),
                   .fusion_rmse_dps = std::sqrt(squares / count)};
}

}  // namespace thermorig::study
