// SPDX-License-Identifier: MIT
#include "evaluate_study_text.h"

#include <fmt/format.h>

#include "evaluate_numbers.h"
#include "print/output.h"

namespace thermorig::app {

namespace {

using study::SettingSummary;

std::vector<std::string> row_of(const SettingSummary& summary) {
  const std::string_view own = summary.fusion ? study::fusion_name : study::thermal_name;
  std::vector<std::string> row{std::to_string(summary.frames),
                               std::to_string(summary.reduction),
                               std::string(own),
                               summary.preset,
                               std::to_string(summary.seed),
                               std::to_string(summary.folds),
                               mse_text(summary.mse[own].median),
                               mse_text(summary.mse[own].iqr),
                               rate_text(summary.rmse_dps[own]),
                               summary.fusion ? gain_text(summary.gain.mean) : "-"};
  for (const std::string& name : study::baselines()) row.push_back(mse_text(summary.mse[name].median));
  return row;
}

}  // namespace

std::string study_text(const std::vector<study::JobResult>& results) {
  std::vector<std::string> header{">Nf",    ">Nr",         "network", "preset",      ">seed",
                                  ">folds", ">median MSE", ">IQR",    ">RMSE deg/s", ">Kg"};
  for (const std::string& name : study::baselines()) header.push_back(">MSE of " + name);
  Table table(header);
  bool simulated = false;
  for (const study::JobResult& result : results) simulated = simulated || result.simulated;
  for (const SettingSummary& summary : study::summarise(results)) table.add(row_of(summary));
  std::string text = table.text();
  if (study::mixes_instruction_sets(results))
    text += fmt::format("computed with {}, which round differently\n",
                        printable(study::instruction_sets_of(results)));
  if (simulated) text += "SIMULATED rig: trends only, not to be set beside figures of real recordings.\n";
  return text;
}

}  // namespace thermorig::app
