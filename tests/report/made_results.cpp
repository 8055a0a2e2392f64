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
  if (std::isnan(mse)) return {0, mse, mse, mse, mse, mse, mse};
  const double rmse = std::sqrt(mse) * scale_dps;
  return {4 * windows_a_speed, mse, rmse, 0.7 * rmse, 2.0 * rmse, 0.1, 0.1};
}

std::array<double, study::estimator_count> mse_of(const MadeJob& job) {
  const double thermal = job.fusion ? 10.0 * job.mse : job.mse;  // a fused network's own y_th is worse
  return {thermal, job.fusion ? job.mse : unknown, job.gyro_mse, job.unbiased_mse};
}

std::vector<study::SpeedErrors> speeds_of(const MadeJob& job) {
  std::vector<study::SpeedErrors> speeds;
  for (const double rate_dps : {-200.0, -20.0, 20.0, 200.0})
    speeds.push_back({rate_dps, windows_a_speed, mse_of(job)});
  return speeds;
}

study::GainStatistics gain_of(const MadeJob& job) {
  study::GainStatistics gain;
  if (!job.fusion) {
    gain.mean = gain.deviation = gain.median = gain.below_002 = gain.above_098 = unknown;
    return gain;
  }
  gain.histogram[static_cast<std::size_t>(job.gain * study::GainStatistics::bins)] = 4 * windows_a_speed;
  gain.mean = gain.median = job.gain;
  gain.below_002 = job.gain < 0.02 ? 1.0 : 0.0;
  gain.above_098 = job.gain > 0.98 ? 1.0 : 0.0;
  return gain;
}

study::AngleTrack track_of(const MadeJob& job) {
  study::AngleTrack track;
  track.drift_deg_per_min = {2.0 * job.drift_deg_per_min, job.fusion ? job.drift_deg_per_min : unknown,
                             job.gyro_drift_deg_per_min, 0.1};
  track.integrated_s = 60.0;
  for (double time_s = 0.0; time_s <= 60.0; time_s += 2.0) {
    track.time_s.push_back(time_s);
    track.commanded_deg.push_back(0.0);
    for (std::size_t i = 0; i < study::estimator_count; ++i)
      if (std::isfinite(track.drift_deg_per_min[i]))
        track.error_deg[i].push_back(track.drift_deg_per_min[i] * time_s / 60.0);
  }
  for (std::size_t i = 0; i < study::estimator_count; ++i)
    track.worst_deg[i] = std::abs(track.drift_deg_per_min[i]);
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
  for (std::size_t i = 0; i < study::estimator_count; ++i) result.evaluation.errors[i] = errors_of(mse[i]);
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
