// SPDX-License-Identifier: MIT
// Fusion against thermal-only and against the gyro, setting by setting.
#include <fmt/format.h>

#include <cmath>

#include "claims.h"
#include "seed_spread.h"
#include "text.h"

namespace thermorig::report {
namespace {

using study::SettingSummary;

/// By what it differs from the reference.
std::string place_of(const StudyView& view, const Setting& setting) {
  return setting.reduction == view.reference.reduction ? fmt::format("Nf = {}", setting.frames)
                                                       : fmt::format("Nr = {}", setting.reduction);
}

/// How often the first of two figures is smaller, the same or larger.
struct Tally {
  int smaller = 0, same = 0, larger = 0;
  int all() const { return smaller + same + larger; }
  void add(Order order) { ++(order == Order::smaller ? smaller : order == Order::same ? same : larger); }
  Verdict verdict() const {
    if (all() == 0) return Verdict::unknown;
    if (smaller == all()) return Verdict::holds;
    if (smaller > 0) return Verdict::holds_in_part;
    return larger > 0 ? Verdict::fails : Verdict::too_close;
  }
  std::string text() const {
    return fmt::format("lower in {}, too close in {}, higher in {} of {} settings", smaller, same, larger,
                       all());
  }
};

Claim compare_setups(const StudyView& view, Claim claim, double (*figure)(const SettingSummary&)) {
  const double factor = larger_seed_factor(view, figure).value_or(1.0);
  Tally tally;
  std::string numbers;
  for (const Setting& setting : view.settings()) {
    const SettingSummary* thermal = view.find(setting, false);
    const SettingSummary* fusion = view.find(setting, true);
    if (thermal == nullptr || fusion == nullptr || !complete(view, *thermal) || !complete(view, *fusion))
      continue;
    const double with = figure(*fusion), without = figure(*thermal);
    if (!std::isfinite(with) || !std::isfinite(without)) continue;
    tally.add(compare(with, without, factor));
    numbers += fmt::format("; {}: {} against {}", place_of(view, setting), mse_text(with), mse_text(without));
  }
  claim.verdict = tally.verdict();
  claim.evidence =
      tally.all() == 0 ? "no setting has all folds of both set-ups" : "fusion is " + tally.text() + numbers;
  return claim;
}

}  // namespace

Claim lower_median_claim(const StudyView& view) {
  return compare_setups(view, {"lower_median", "Fusion has the lower median MSE"}, median_of);
}

Claim smaller_spread_claim(const StudyView& view) {
  if (view.folds.size() < 2)
    return {"smaller_spread", "Fusion has the smaller spread (IQR) over folds", Verdict::unknown,
            "one fold has no spread"};
  return compare_setups(view, {"smaller_spread", "Fusion has the smaller spread (IQR) over folds"}, iqr_of);
}

Claim beats_claim(const StudyView& view, const std::string& baseline) {
  Claim claim{"beats_" + baseline, fmt::format("Fusion has a lower median MSE than {}", baseline)};
  claim.of_paper = false;
  const double factor = seed_factor(view, true, median_of).value_or(1.0);
  Tally tally;
  std::string numbers;
  for (const Setting& setting : view.settings()) {
    const SettingSummary* fusion = view.find(setting, true);
    if (fusion == nullptr || !complete(view, *fusion)) continue;
    const double with = median_of(*fusion), without = fusion->mse[baseline].median;
    if (!std::isfinite(with) || !std::isfinite(without)) continue;
    tally.add(compare(with, without, factor));
    numbers += fmt::format("; {}: {} against {}", place_of(view, setting), mse_text(with), mse_text(without));
  }
  claim.verdict = tally.verdict();
  claim.evidence = tally.all() == 0 ? "no setting has all folds of fusion and " + baseline
                                    : "fusion is " + tally.text() + numbers;
  return claim;
}

}  // namespace thermorig::report
