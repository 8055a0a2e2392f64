// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "thermorig/learning/study/study.h"

namespace thermorig::tests {

/// What a made-up job says; everything else of its result follows from it.
struct MadeJob {
  int frames = 3, reduction = 1;
  bool fusion = true;
  std::uint64_t seed = 1;
  std::string fold = "garden-1";
  double mse = 0.01;         // of the set-up's own estimator
  double gyro_mse = 0.02;    // of the gyro
  double rest_mse = 0.0005;  // of gyro-rest; gyro-kalman says nothing
  double gain = 0.55;        // in one bin of the histogram
  double drift_deg_per_min = 1.0;
  double gyro_drift_deg_per_min = -60.0;
};

study::JobResult made_result(const MadeJob& job);

/// All 84 jobs of a study with three seeds at the reference: thermal-only 0.010 and fusion 0.005 times
/// the fold's number / 3.5, times Nr, times 1 + |Nf - 3| / 2, times `seed_step` a seed.
std::vector<study::JobResult> made_study(double seed_step = 1.05);

}  // namespace thermorig::tests
