// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "thermorig/learning/study/study.h"

namespace thermorig::report {

/// Nf and Nr.
struct Setting {
  int frames = 0, reduction = 0;
  auto operator<=>(const Setting&) const = default;
};

/// Results that may stand in one table: of the same data, label, preset, epochs and end frames.
struct StudyView {
  std::string preset, data_hash;
  Label label = Label::commanded;
  std::string settings_text;  // what the preset stands for
  int epochs = 0, history = 0;
  std::vector<study::JobResult> results;  // sorted by job, each job once
  std::vector<study::SettingSummary> summaries;
  std::vector<std::string> folds;       // names of all test acquisitions seen, sorted
  std::vector<std::uint64_t> seeds;     // ascending
  std::vector<std::string> baselines;   // of study::baselines() those that any result says something of
  std::vector<std::string> estimators;  // both of the network, and these
  Setting reference;                    // that both sweeps share: the paper's where it has results
  std::uint64_t table_seed = 1;         // whose results stand in the tables: the one with most
  double label_scale_dps = 0.0;         // what MSEs are divided by, squared
  bool simulated = false;               // any of it

  /// "ours, SIMULATED rig" or "ours, real data".
  std::string ours() const;
  std::string reference_text() const;  // "Nf = 3, Nr = 1"
  /// The paper's settings and ours, with the other one at the reference.
  std::vector<Setting> frame_sweep() const;
  std::vector<Setting> reduction_sweep() const;
  std::vector<Setting> settings() const;  // of both sweeps, each once

  /// Nothing where no job of it has a result.
  const study::SettingSummary* find(Setting setting, bool fusion, std::uint64_t seed) const;
  const study::SettingSummary* find(Setting setting, bool fusion) const {
    return find(setting, fusion, table_seed);
  }
  /// The summary that has most folds, for what does not depend on the set-up: the gyro's own rows.
  const study::SettingSummary* find_any(Setting setting) const;
  /// Sorted by fold.
  std::vector<const study::JobResult*> jobs(Setting setting, bool fusion, std::uint64_t seed) const;
  std::vector<const study::JobResult*> jobs(Setting setting, bool fusion) const {
    return jobs(setting, fusion, table_seed);
  }
  const study::JobResult* job(Setting setting, bool fusion, const std::string& fold) const;
  /// At the reference, whose numbers an estimator is judged by: thermal's is of the thermal-only network,
  /// fusion's of the fused one, a baseline's of the fused one or else of the other. Nothing without a result.
  const study::JobResult* job_of(std::string_view estimator, const std::string& fold) const;
  std::string folds_text(const study::SettingSummary& summary) const;  // "4 of 6 folds"
};

/// The studies in the results; Error(bad_usage) without any.
std::vector<StudyView> views_of(std::span<const study::JobResult> results);

/// Whose numbers a set-up is judged by.
constexpr std::string_view estimator_of(bool fusion) {
  return fusion ? study::fusion_name : study::thermal_name;
}

/// Root of an MSE in deg/s.
double rmse_of(double mse, double label_scale_dps);

}  // namespace thermorig::report
