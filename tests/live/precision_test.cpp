// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "causal_run.h"
#include "thermorig/live/live_estimator.h"
#include "thermorig/model/model.h"

namespace thermorig::live {
namespace {

TEST(HalfPrecision, StaysWithinATenthOfADegreeASecond) {
  const auto model = std::optional(model::read_model(THERMORIG_SOURCE_DIR "/docs/models/best.onnx"));
  LiveEstimator full(model), half(model, network::Precision::fp16_weights);
  double furthest_dps = 0.0;
  int compared = 0, different = 0;
  for (const auto& [measurement, arrived] : measurements_of(two_legs())) {
    const LiveEstimate one = full.add(measurement, arrived);
    const LiveEstimate other = half.add(measurement, arrived);
    EXPECT_EQ(std::isfinite(one.rate_fusion_dps), std::isfinite(other.rate_fusion_dps));
    if (!one.counted) continue;
    for (const auto rate : {&LiveEstimate::rate_thermal_dps, &LiveEstimate::rate_fusion_dps})
      furthest_dps = std::max(furthest_dps, std::abs(double{one.*rate} - double{other.*rate}));
    different += one.rate_fusion_dps != other.rate_fusion_dps ? 1 : 0;
    ++compared;
  }
  RecordProperty("furthest_dps", std::to_string(furthest_dps));
  EXPECT_GT(compared, 30);
  EXPECT_GT(different, compared / 2) << "it is the same network twice";
  EXPECT_LE(furthest_dps, 0.1);
}

}  // namespace
}  // namespace thermorig::live
