// SPDX-License-Identifier: MIT
#include "seed_spread.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace thermorig::report {

double median_of(const study::SettingSummary& summary) {
  return summary.mse[estimator_of(summary.fusion)].median;
}

double iqr_of(const study::SettingSummary& summary) {
  return summary.mse[estimator_of(summary.fusion)].iqr;
}

std::vector<const study::SettingSummary*> reference_seeds(const StudyView& view, bool fusion) {
  std::vector<const study::SettingSummary*> found;
  const study::SettingSummary* table = view.find(view.reference, fusion);
  if (table == nullptr) return found;
  for (const std::uint64_t seed : view.seeds) {
    const study::SettingSummary* summary = view.find(view.reference, fusion, seed);
    if (summary != nullptr && summary->folds == table->folds) found.push_back(summary);
  }
  return found;
}

std::optional<double> seed_factor(const StudyView& view, bool fusion, const Figure& figure) {
  const auto seeds = reference_seeds(view, fusion);
  if (seeds.size() < 2) return std::nullopt;
  double smallest = std::numeric_limits<double>::infinity(), largest = 0.0;
  for (const study::SettingSummary* summary : seeds) {
    const double value = figure(*summary);
    if (!std::isfinite(value) || value <= 0.0) return std::nullopt;
    smallest = std::min(smallest, value), largest = std::max(largest, value);
  }
  return largest / smallest;
}

std::optional<double> larger_seed_factor(const StudyView& view, const Figure& figure) {
  const auto of_thermal = seed_factor(view, false, figure);
  const auto of_fusion = seed_factor(view, true, figure);
  if (!of_thermal || !of_fusion) return of_thermal ? of_thermal : of_fusion;
  return std::max(*of_thermal, *of_fusion);
}

bool complete(const StudyView& view, const study::SettingSummary& summary) {
  return summary.folds == view.folds.size();
}

Order compare(double a, double b, double factor) {
  factor = std::max(factor, least_factor);
  if (a * factor < b) return Order::smaller;
  if (b * factor < a) return Order::larger;
  return Order::same;
}

}  // namespace thermorig::report
