// SPDX-License-Identifier: MIT
#pragma once

#include <limits>
#include <vector>

#include "thermorig/learning/study/evaluation.h"

namespace thermorig::study {

inline constexpr float nan = std::numeric_limits<float>::quiet_NaN();

/// An acquisition of N frames, 0.1 s apart, all in run 1 and one leg at `rate_dps`; no pixels.
inline network::Acquisition plain_acquisition(const std::string& name, std::size_t frames, float rate_dps) {
  network::Acquisition acquisition;
  acquisition.name = name;
  acquisition.environment = "garden";
  acquisition.label_dps.assign(frames, rate_dps);
  acquisition.gyro_dps.assign(frames, rate_dps);
  acquisition.leg_rate_dps.assign(frames, rate_dps);
  acquisition.run.assign(frames, 1);
  for (std::size_t i = 0; i < frames; ++i)
    acquisition.time.push_back(host_time_ns(static_cast<std::int64_t>(i) * 100'000'000));
  return acquisition;
}

/// A window that estimators are wrong of by so much.
inline JudgedWindow judged(std::uint32_t last, float label_dps, float thermal_error, float fusion_error,
                           float gyro_error, float gain = 0.5F) {
  JudgedWindow judged{.window = {0, last}, .label_dps = label_dps, .gain = gain};
  judged.rate_dps[thermal_name] = label_dps + thermal_error;
  judged.rate_dps[fusion_name] = label_dps + fusion_error;
  judged.rate_dps[gyro_name] = label_dps + gyro_error;
  return judged;
}

}  // namespace thermorig::study
