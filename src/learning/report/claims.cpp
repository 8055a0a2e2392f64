// SPDX-License-Identifier: MIT
#include "claims.h"

#include <fmt/format.h>

#include <algorithm>

#include "seed_spread.h"

namespace thermorig::report {
namespace {

std::string factor_text(std::optional<double> factor) {
  return factor ? fmt::format("{:.2f}", *factor) : std::string("not known");
}

}  // namespace

std::string text_of(Verdict verdict, bool seeds) {
  switch (verdict) {
    case Verdict::holds:
      return "holds";
    case Verdict::holds_in_part:
      return "holds in part";
    case Verdict::too_close:
      return seeds ? "within the spread of seeds" : "too close to tell";
    case Verdict::fails:
      return "does not hold";
    case Verdict::unknown:
      break;
  }
  return "cannot be told";
}

bool seeds_known(const StudyView& view) {
  return reference_seeds(view, false).size() > 1 || reference_seeds(view, true).size() > 1;
}

std::string judging_text(const StudyView& view) {
  const std::string rule = fmt::format(
      "Every verdict is computed from the results, from those settings that have all folds. Two figures "
      "count "
      "as different where they are more than {:.0f} % apart",
      100.0 * (least_factor - 1.0));
  if (!seeds_known(view))
    return fmt::format(
        "{}. The spread over seeds is not known (it takes two seeds or more at {}): take the verdicts with "
        "care.",
        rule, view.reference_text());
  return fmt::format(
      "{} and their ratio is larger than the largest ratio between the {} seeds at {} (median: thermal-only "
      "{}, "
      "fusion {}; IQR: thermal-only {}, fusion {}); closer ones are within the spread of seeds.",
      rule, std::max(reference_seeds(view, false).size(), reference_seeds(view, true).size()),
      view.reference_text(), factor_text(seed_factor(view, false, median_of)),
      factor_text(seed_factor(view, true, median_of)), factor_text(seed_factor(view, false, iqr_of)),
      factor_text(seed_factor(view, true, iqr_of)));
}

std::vector<Claim> claims_of(const StudyView& view) {
  std::vector<Claim> claims{
      lower_median_claim(view),      smaller_spread_claim(view), growth_claim(view, false),
      growth_claim(view, true),      less_growth_claim(view),    best_frames_claim(view, false),
      best_frames_claim(view, true), drift_claim(view),          gain_peak_claim(view)};
  for (const std::string& name : view.baselines) claims.push_back(beats_claim(view, name));
  return claims;
}

}  // namespace thermorig::report
