// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>

#include "left_out.h"
#include "result_file.h"
#include "thermorig/core/error.h"

namespace thermorig::study {

namespace {

using network::Acquisition;

/// Are they over the same windows, so that their rows may stand in one table?
bool have_same_windows(const Evaluation& a, const Evaluation& b) {
  const auto is_same = [](const SpeedErrors& one, const SpeedErrors& other) {
    return one.rate_dps == other.rate_dps && one.windows == other.windows;
  };
  return a.errors[gyro_name].windows == b.errors[gyro_name].windows &&
         std::ranges::equal(a.speeds, b.speeds, is_same) && a.angles.size() == 1 && b.angles.size() == 1 &&
         a.angles[0].time_s == b.angles[0].time_s;
}

void take(const std::string& name, const Evaluation& from, Evaluation& to) {
  to.errors[name] = from.errors[name];
  to.shaft_errors[name] = from.shaft_errors[name];
  for (std::size_t speed = 0; speed < to.speeds.size(); ++speed)
    to.speeds[speed].mse[name] = from.speeds[speed].mse[name];
  to.angles[0].error_deg[name] = from.angles[0].error_deg[name];
  to.angles[0].drift_deg_per_min[name] = from.angles[0].drift_deg_per_min[name];
  to.angles[0].worst_deg[name] = from.angles[0].worst_deg[name];
  to.angles[0].settled_drift_deg_per_min[name] = from.angles[0].settled_drift_deg_per_min[name];
  to.angles[0].settled_worst_deg[name] = from.angles[0].settled_worst_deg[name];
}

JobResult with_baselines(JobResult result, std::span<const Acquisition> acquisitions) {
  const Acquisition& left_out = left_out_of(result.job, acquisitions);
  const auto judged = judged_windows({&left_out, 1}, test_windows(result.job, left_out), result.job.frames);
  const Evaluation found = evaluation_of(judged, left_out, result.label_scale_dps);
  if (!have_same_windows(found, result.evaluation))
    throw Error(ExitCode::bad_usage, "the result was made of other windows than these sessions have",
                result.job.test, "run the study again: the rule for windows has changed since");
  for (const std::string& name : baselines()) take(name, found, result.evaluation);
  return result;
}

}  // namespace

RenewedBaselines renew_baselines(const std::filesystem::path& folder,
                                 std::span<const Acquisition> acquisitions) {
  std::vector<JobResult> renewed = read_results(folder);
  std::vector<bool> changed;
  for (JobResult& result : renewed) {
    const std::string before = to_json(result);
    result = with_baselines(std::move(result), acquisitions);
    changed.push_back(to_json(result) != before);
  }
  RenewedBaselines counts{.results = renewed.size()};
  for (std::size_t i = 0; i < renewed.size(); ++i) {
    if (!changed[i]) continue;
    replace_result(folder, renewed[i]);
    ++counts.changed;
  }
  return counts;
}

}  // namespace thermorig::study
