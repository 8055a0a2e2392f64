// SPDX-License-Identifier: MIT
#include "thermorig/learning/study/evaluation.h"
#include "thermorig/learning/training/prediction.h"

namespace thermorig::study {

namespace {

/// NaN where the gate states no sigma, or the filter says nothing.
float fused_with_kalman(const JudgedWindow& judged, const network::Acquisition& acquisition, int frames) {
  for (const network::RateSeries& gyro : acquisition.rates) {
    if (gyro.name != kalman_name || gyro.frames != 1) continue;
    const float bias_sigma_dps = network::mean_rate(gyro.bias_sigma_dps, judged.window, frames);
    const auto gain =
        static_cast<float>(network::gain_beside(double{bias_sigma_dps}, double{judged.sigma_dps}));
    return gain * judged.rate_dps[thermal_name] + (1.0F - gain) * judged.rate_dps[kalman_name];
  }
  return std::numeric_limits<float>::quiet_NaN();
}

}  // namespace

std::vector<JudgedWindow> judged_windows(std::span<const network::Acquisition> acquisitions,
                                         std::span<const network::Window> windows, int frames) {
  std::vector<JudgedWindow> judged;
  judged.reserve(windows.size());
  for (const network::Window& window : windows) {
    const network::Acquisition& acquisition = acquisitions[window.acquisition];
    JudgedWindow& one = judged.emplace_back(JudgedWindow{window});
    one.label_dps = network::mean_rate(acquisition.label_dps, window, frames);
    if (!acquisition.shaft_dps.empty())
      one.shaft_dps = network::mean_rate(acquisition.shaft_dps, window, frames);
    // What is found of a window at once stands behind what is found frame by frame.
    for (const network::RateSeries& series : acquisition.rates)
      if (series.frames <= frames)
        one.rate_dps[series.name] = network::mean_rate(series.rate_dps, window, frames - series.frames + 1);
    if (acquisition.bound_frames == frames) one.bound_dps = acquisition.bound_dps[window.last];
  }
  return judged;
}

std::vector<JudgedWindow> judged_windows(const model::Model& model,
                                         std::span<const network::Acquisition> acquisitions,
                                         std::span<const network::Window> windows, int turned) {
  const network::Shape& shape = model.weights.shape;
  std::vector<JudgedWindow> judged = judged_windows(acquisitions, windows, shape.frames);
  const auto estimates = training::predict(model, acquisitions, windows, turned);
  for (std::size_t i = 0; i < judged.size(); ++i) {
    judged[i].rate_dps[thermal_name] = estimates[i].thermal_dps;
    if (!shape.fusion) continue;
    judged[i].rate_dps[fusion_name] = estimates[i].fusion_dps;
    judged[i].gain = estimates[i].gain;
    judged[i].sigma_dps = estimates[i].thermal_sigma_dps;
    judged[i].rate_dps[kalman_fusion_name] =
        fused_with_kalman(judged[i], acquisitions[judged[i].window.acquisition], shape.frames);
  }
  return judged;
}

}  // namespace thermorig::study
