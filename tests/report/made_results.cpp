// SPDX-License-Identifier: MIT
#include "made_results.h"

#include <cmath>
#include <limits>

namespace thermorig::tests {
namespace {

constexpr double scale_dps = 200.0;
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
constexpr std::uint64_t windows_a_speed = 40;

study::Errors errors_of(double mse) {
  if (std::isnan(mse)) return {};
  const double rmse = std::sqrt(mse) * scale_dps;
  return {4 * windows_a_speed, mse, rmse, 0.7 * rmse, 2.0 * rmse, 0.1, 0.1};
}

study::PerEstimator<double> mse_of(const MadeJob& job) {
  study::PerEstimator<double> mse(unknown);
  mse[study::thermal_name] = job.fusion ? 10.0 * job.mse : job.mse;  // a fused network's own y_th is worse
  if (job.fusion) mse[study::fusion_name] = job.mse;
  mse["gyro"] = job.gyro_mse;
  mse["gyro-rest"] = job.rest_mse;
  return mse;
}

std::vector<study::SpeedErrors> speeds_of(const MadeJob& job) {
  std::vector<study::SpeedErrors> speeds;
  for (const double rate_dps : {-200.0, -20.0, 20.0, 200.0})
    speeds.push_back({rate_dps, windows_a_speed, mse_of(job)});
  return speeds;
}

study::GainStatistics gain_of(const MadeJob& job) {
  study::GainStatistics gain;
  if (!job.fusion) return gain;
  gain.deviation = 0.0;
  gain.histogram[static_cast<std::size_t>(job.gain * study::GainStatistics::bins)] = 4 * windows_a_speed;
  gain.mean = gain.median = job.gain;
  gain.below_002 = job.gain < 0.02 ? 1.0 : 0.0;
  gain.above_098 = job.gain > 0.98 ? 1.0 : 0.0;
  return gain;
}

study::AngleTrack track_of(const MadeJob& job) {
  study::AngleTrack track;
  track.drift_deg_per_min[study::thermal_name] = 2.0 * job.drift_deg_per_min;
  if (job.fusion) track.drift_deg_per_min[study::fusion_name] = job.drift_deg_per_min;
  track.drift_deg_per_min["gyro"] = job.gyro_drift_deg_per_min;
  track.drift_deg_per_min["gyro-rest"] = 0.1;
  track.integrated_s = 60.0;
  for (double time_s = 0.0; time_s <= 60.0; time_s += 2.0) {
    track.time_s.push_back(time_s);
    track.commanded_deg.push_back(0.0);
    for (const std::string& name : study::all_estimators())
      if (std::isfinite(track.drift_deg_per_min[name]))
        track.error_deg[name].push_back(track.drift_deg_per_min[name] * time_s / 60.0);
  }
  for (const std::string& name : study::all_estimators())
    track.worst_deg[name] = std::abs(track.drift_deg_per_min[name]);
  return track;
}

}  // namespace

study::JobResult made_result(const MadeJob& made) {
  study::JobResult result;
  result.job.frames = made.frames;
  result.job.reduction = made.reduction;
  result.job.fusion = made.fusion;
  result.job.seed = made.seed;
  result.job.preset = "paper";
  result.job.test = made.fold;
  result.job.test_hash = "hash of " + made.fold;
  result.job.data_hash = "0123456789abcdef";
  const auto mse = mse_of(made);
  for (const std::string& name : study::all_estimators())
    result.evaluation.errors[name] = errors_of(mse[name]);
  result.evaluation.speeds = speeds_of(made);
  result.evaluation.gain = gain_of(made);
  result.evaluation.angles = {track_of(made)};
  result.evaluation.names = {made.fold};
  result.simulated = true;
  result.training_mse = {0.1, 0.01, 0.001};
  result.epoch_kept = 3;
  result.weights = made.fusion ? 750274 : 381393;
  result.multiply_adds = made.fusion ? 1553480 : 1184720;
  result.seconds = 100.0;
  result.instruction_set = "avx2";
  return result;
}

std::vector<study::JobResult> made_study(double seed_step) {
  std::vector<study::JobResult> results;
  const auto add = [&](int frames, int reduction, std::uint64_t seed) {
    for (const bool fusion : {false, true})
      for (int fold = 1; fold <= 6; ++fold) {
        const double setting = reduction * (1.0 + std::abs(frames - 3) / 2.0);
        const double of_seed = std::pow(seed_step, static_cast<double>(seed - 1));
        const double mse = (fusion ? 0.005 : 0.010) * fold / 3.5 * setting * of_seed;
        results.push_back(
            made_result({frames, reduction, fusion, seed, "garden-" + std::to_string(fold), mse}));
      }
  };
  for (const std::uint64_t seed : {1U, 2U, 3U}) add(3, 1, seed);
  for (const int frames : {2, 4, 5, 6}) add(frames, 1, 1);
  for (const int reduction : {2, 3}) add(3, reduction, 1);
  return results;
}

}  // namespace thermorig::tests
