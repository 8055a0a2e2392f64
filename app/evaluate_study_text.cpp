// SPDX-License-Identifier: MIT
#include "evaluate_study_text.h"

#include <fmt/format.h>

#include "evaluate_numbers.h"
#include "output.h"

namespace thermorig::app {

namespace {

using study::Estimator;
using study::SettingSummary;

std::vector<std::string> row_of(const SettingSummary& summary) {
  const auto own = static_cast<std::size_t>(summary.fusion ? Estimator::fusion : Estimator::thermal);
  const auto median = [&](Estimator estimator) {
    return mse_text(summary.mse[static_cast<std::size_t>(estimator)].median);
  };
  return {std::to_string(summary.frames),
          std::to_string(summary.reduction),
          study::name_of(static_cast<Estimator>(own)),
          summary.preset,
          std::to_string(summary.seed),
          std::to_string(summary.folds),
          mse_text(summary.mse[own].median),
          mse_text(summary.mse[own].iqr),
          rate_text(summary.rmse_dps[own]),
          median(Estimator::gyro),
          median(Estimator::gyro_unbiased),
          summary.fusion ? gain_text(summary.gain.mean) : "-"};
}

}  // namespace

std::string study_text(const std::vector<study::JobResult>& results) {
  Table table({">Nf", ">Nr", "set-up", "preset", ">seed", ">folds", ">median MSE", ">IQR", ">RMSE deg/s",
               ">gyro MSE", ">bias removed", ">Kg"});
  bool simulated = false;
  for (const study::JobResult& result : results) simulated = simulated || result.simulated;
  for (const SettingSummary& summary : study::summarise(results)) table.add(row_of(summary));
  return table.text() +
         (simulated ? "SIMULATED rig: trends only, not to be set beside figures of real recordings.\n" : "");
}

}  // namespace thermorig::app
