// SPDX-License-Identifier: MIT
#include "claims.h"

#include <fmt/format.h>

#include "seed_spread.h"

namespace thermorig::report {
namespace {

std::string factor_text(std::optional<double> factor) {
  return factor ? fmt::format("{:.2f}", *factor) : std::string("not known");
}

}  // namespace

std::string text_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::holds:
      return "holds";
    case Verdict::holds_in_part:
      return "holds in part";
    case Verdict::within_seeds:
      return "within the spread of seeds";
    case Verdict::fails:
      return "does not hold";
    case Verdict::unknown:
      break;
  }
  return "cannot be told";
}

std::string judging_text(const StudyView& view) {
  const auto count = std::max(reference_seeds(view, false).size(), reference_seeds(view, true).size());
  if (count < 2)
    return fmt::format(
        "Every verdict is computed from the results. The spread over seeds is not known (it takes two "
        "seeds or more at {}), so the smallest difference decides: take the verdicts with "
        "care.",
        view.reference_text());
  return fmt::format(
      "Every verdict is computed from the results. Two figures count as different where their ratio is "
      "larger "
      "than the largest ratio between the {} seeds at {} (median: thermal-only {}, fusion {}; "
      "IQR: "
      "thermal-only {}, fusion {}); closer ones are within the spread of seeds.",
      count, view.reference_text(), factor_text(seed_factor(view, false, median_of)),
      factor_text(seed_factor(view, true, median_of)), factor_text(seed_factor(view, false, iqr_of)),
      factor_text(seed_factor(view, true, iqr_of)));
}

std::vector<Claim> claims_of(const StudyView& view) {
  return {lower_median_claim(view),
          smaller_spread_claim(view),
          growth_claim(view, false),
          growth_claim(view, true),
          less_growth_claim(view),
          best_frames_claim(view, false),
          best_frames_claim(view, true),
          drift_claim(view),
          gain_peak_claim(view),
          beats_gyro_claim(view, study::Estimator::gyro),
          beats_gyro_claim(view, study::Estimator::gyro_unbiased)};
}

}  // namespace thermorig::report
