// SPDX-License-Identifier: MIT
#include "bound_errors.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "thermorig/core/statistics.h"

namespace thermorig::study {

namespace {

constexpr double normal_median = 0.674489750196082;  // of the size of a normal error, in its deviations

double median_of(std::vector<double>& values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? unknown : quantile(values, 0.5);
}

/// A window that does not depend on the rate at all has an infinite bound.
bool has_bound(const JudgedWindow& one) {
  return one.bound_dps > 0.0F && std::isfinite(one.label_dps);
}

void add_estimator(std::span<const JudgedWindow> judged, const std::string& name, BoundErrors& errors) {
  std::vector<double> multiples;
  double squares = 0.0, bound_squares = 0.0;
  for (const JudgedWindow& one : judged) {
    const double error_dps = double{one.rate_dps[name]} - double{one.label_dps};
    if (!has_bound(one) || !std::isfinite(error_dps)) continue;
    const double bound_dps = double{one.bound_dps};
    multiples.push_back(std::abs(error_dps) / bound_dps);
    if (bound_dps >= BoundErrors::well_told_dps) continue;
    squares += error_dps * error_dps;
    bound_squares += bound_dps * bound_dps;
  }
  errors.median[name] = median_of(multiples) / normal_median;
  errors.well_told_rmse[name] = std::sqrt(squares / bound_squares);
}

}  // namespace

std::optional<BoundErrors> bound_errors(std::span<const JudgedWindow> judged) {
  BoundErrors errors;
  std::vector<double> bounds_dps;
  for (const JudgedWindow& one : judged)
    if (has_bound(one)) bounds_dps.push_back(double{one.bound_dps});
  if (bounds_dps.empty()) return std::nullopt;
  errors.windows = bounds_dps.size();
  errors.well_told = static_cast<std::uint64_t>(std::count_if(
      bounds_dps.begin(), bounds_dps.end(), [](double bound) { return bound < BoundErrors::well_told_dps; }));
  errors.median_dps = median_of(bounds_dps);
  for (const std::string& name : all_estimators()) add_estimator(judged, name, errors);
  return errors;
}

}  // namespace thermorig::study
