// SPDX-License-Identifier: MIT
#include <limits>

#include "folder_lock.h"
#include "left_out.h"
#include "result_file.h"
#include "thermorig/core/error.h"

namespace thermorig::study {

namespace {

using windows::Acquisition;

constexpr std::array baselines{Estimator::gyro, Estimator::gyro_unbiased};

/// What is known of the job's windows without any network.
std::vector<training::WindowEstimate> gyro_estimates(const Job& job, const Acquisition& left_out) {
  constexpr float unknown = std::numeric_limits<float>::quiet_NaN();
  std::vector<training::WindowEstimate> estimates;
  for (const windows::Window& window : test_windows(job, left_out)) {
    const windows::WindowRates rates = windows::rates_of(left_out, window, job.frames);
    estimates.push_back({.window = window,
                         .time = left_out.time[window.last],
                         .label_dps = rates.label_dps,
                         .gyro_dps = rates.gyro_dps,
                         .thermal_dps = unknown,
                         .fusion_dps = unknown,
                         .gain = unknown});
  }
  return estimates;
}

bool have_same_speeds(const std::vector<SpeedErrors>& a, const std::vector<SpeedErrors>& b) {
  bool same = a.size() == b.size();
  for (std::size_t i = 0; same && i < a.size(); ++i)
    same = a[i].rate_dps == b[i].rate_dps && a[i].windows == b[i].windows;
  return same;
}

/// Are they over the same windows, so that their rows may stand in one table?
bool have_same_windows(const Evaluation& a, const Evaluation& b) {
  const auto gyro = static_cast<std::size_t>(Estimator::gyro);
  return a.errors[gyro].windows == b.errors[gyro].windows && have_same_speeds(a.speeds, b.speeds) &&
         a.angles.size() == 1 && b.angles.size() == 1 && a.angles[0].time_s == b.angles[0].time_s;
}

void take(Estimator estimator, const Evaluation& from, Evaluation& to) {
  const auto i = static_cast<std::size_t>(estimator);
  to.errors[i] = from.errors[i];
  for (std::size_t speed = 0; speed < to.speeds.size(); ++speed)
    to.speeds[speed].mse[i] = from.speeds[speed].mse[i];
  to.angles[0].error_deg[i] = from.angles[0].error_deg[i];
  to.angles[0].drift_deg_per_min[i] = from.angles[0].drift_deg_per_min[i];
  to.angles[0].worst_deg[i] = from.angles[0].worst_deg[i];
}

}  // namespace

JobResult with_baselines(JobResult result, std::span<const Acquisition> acquisitions) {
  const Acquisition& left_out = left_out_of(result.job, acquisitions);
  const Evaluation found =
      evaluation_of(gyro_estimates(result.job, left_out), result.job, left_out, result.label_scale_dps);
  if (!have_same_windows(found, result.evaluation))
    throw Error(ExitCode::bad_usage, "the result was made of other windows than these sessions have",
                result.job.test, "run the study again: the rule for windows has changed since");
  for (const Estimator estimator : baselines) take(estimator, found, result.evaluation);
  return result;
}

RenewedBaselines renew_baselines(const std::filesystem::path& folder,
                                 std::span<const Acquisition> acquisitions) {
  read_results(folder);  // refuses a folder without any, before a lock is left in it
  const FolderLock lock(folder);
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
    write_result(folder, renewed[i]);
    ++counts.changed;
  }
  return counts;
}

}  // namespace thermorig::study
