// SPDX-License-Identifier: MIT
// What integration over time shows, and where the gate stands.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "claims.h"
#include "drift_figures.h"
#include "gain_figures.h"
#include "paper_figures.h"
#include "seed_spread.h"
#include "text.h"

namespace thermorig::report {
namespace {

constexpr double stays_share = 0.1;  // fusion "stays with the truth" where it drifts at most this of the gyro
constexpr double near_peak = 0.1;    // "near 0.55"

Verdict drift_verdict(double fusion, double gyro) {
  if (compare(fusion, gyro, least_factor) != Order::smaller) return Verdict::fails;
  return fusion <= stays_share * gyro ? Verdict::holds : Verdict::holds_in_part;
}

/// Of all seeds' networks; too close where seeds disagree.
Verdict drift_verdict(const StudyView& view, double gyro) {
  std::set<Verdict> verdicts;
  for (const study::SettingSummary* summary : reference_seeds(view, true))
    verdicts.insert(drift_verdict(fusion_drift(view, summary->seed), gyro));
  return verdicts.size() == 1 ? *verdicts.begin() : Verdict::too_close;
}

std::string drift_text(const StudyView& view, const std::string& estimator) {
  const DriftSummary drift = drift_summary(view, estimator);
  return fmt::format("{} {} (worst angle {} deg)", estimator, rate_text(drift.median_deg_per_min),
                     angle_text(drift.worst_deg));
}

}  // namespace

Claim drift_claim(const StudyView& view) {
  Claim claim{"drift", "Gyro-only integration drifts away and fusion stays with the truth"};
  const std::string fusion_name(study::fusion_name);
  const DriftSummary fusion = drift_summary(view, fusion_name),
                     gyro = drift_summary(view, std::string(study::gyro_name));
  if (fusion.folds == 0 || gyro.folds == 0) {
    claim.evidence = "no angle of both at " + view.reference_text();
    return claim;
  }
  claim.verdict = drift_verdict(view, gyro.median_deg_per_min);
  claim.evidence = "median |drift| over folds, deg/min: " + drift_text(view, fusion_name);
  for (const std::string& name : view.baselines) claim.evidence += "; " + drift_text(view, name);
  claim.evidence +=
      ". It holds where fusion drifts at most a tenth as fast as the gyro, partly where it is only slower";
  return claim;
}

Claim gain_peak_claim(const StudyView& view) {
  Claim claim{"gain_peak", fmt::format("Kg peaks near {:.2f}", paper_gain_peak)};
  int near = 0, all = 0;
  for (const study::SettingSummary* summary : reference_seeds(view, true)) {
    if (summary->gain.windows() == 0) continue;
    const double peak = peak_of(summary->gain);
    ++all;
    if (std::abs(peak - paper_gain_peak) <= near_peak && !study::collapsed(summary->gain)) ++near;
    claim.evidence += fmt::format(
        "{}seed {}: peak at {:.3f}, mean {:.2f}, {} below 0.02, {} above 0.98, gate {}", all == 1 ? "" : "; ",
        summary->seed, peak, summary->gain.mean, share_text(summary->gain.below_002),
        share_text(summary->gain.above_098), gate_text(summary->gain));
  }
  if (all == 0) {
    claim.evidence = "no gate at " + view.reference_text();
    return claim;
  }
  claim.verdict = near == all ? Verdict::holds : near == 0 ? Verdict::fails : Verdict::too_close;
  claim.evidence += fmt::format(". Near is within {:.2f}", near_peak);
  return claim;
}

}  // namespace thermorig::report
