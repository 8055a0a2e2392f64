// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <optional>

#include "study_view.h"

namespace thermorig::report {

/// By what factor a figure differs between seeds at the reference setting: largest / smallest, at least 1.
/// Nothing with fewer than two seeds whose folds are the same number as the table seed's, or where the figure
/// is 0 or not known.
using Figure = std::function<double(const study::SettingSummary&)>;
std::optional<double> seed_factor(const StudyView& view, bool fusion, const Figure& figure);

/// The larger of both set-ups' factors.
std::optional<double> larger_seed_factor(const StudyView& view, const Figure& figure);

double median_of(const study::SettingSummary& summary);  // of the set-up's own estimator
double iqr_of(const study::SettingSummary& summary);

/// Has it all folds of the study?
bool complete(const StudyView& view, const study::SettingSummary& summary);

/// Summaries at the reference setting with as many folds as the table seed's, ascending by seed.
std::vector<const study::SettingSummary*> reference_seeds(const StudyView& view, bool fusion);

/// Figures closer than this are the same whatever the seeds say: a gate that has collapsed gives the gyro's
/// figures but for rounding, with every seed.
inline constexpr double least_factor = 1.05;

/// How `a` stands to `b` where figures closer than `factor`, or than least_factor, cannot be told apart.
enum class Order { smaller, same, larger };
Order compare(double a, double b, double factor);

}  // namespace thermorig::report
