// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "../support/paper_estimates.h"
#include "causal_run.h"
#include "thermorig/estimators/live/live_estimates.h"
#include "thermorig/network/model/model.h"

namespace thermorig::live {
namespace {

TEST(HalfPrecision, StaysWithinATenthOfADegreeASecond) {
  const auto model = std::optional(model::read_model(THERMORIG_SOURCE_DIR "/docs/models/best.onnx"));
  LiveEstimates full(paper_bank(model)), half(paper_bank(model, network::Precision::fp16_weights));
  double furthest_dps = 0.0;
  int compared = 0, different = 0;
  for (const auto& [measurement, arrived] : measurements_of(two_legs())) {
    const EstimateRow one = full.add(measurement, arrived);
    const EstimateRow other = half.add(measurement, arrived);
    EXPECT_EQ(std::isfinite(fusion_dps(one)), std::isfinite(fusion_dps(other)));
    if (!one.counted) continue;
    for (const PaperEstimator of : {of_thermal, of_fusion})
      furthest_dps = std::max(
          furthest_dps, std::abs(double{one.estimates[of].rate_dps} - double{other.estimates[of].rate_dps}));
    different += fusion_dps(one) != fusion_dps(other) ? 1 : 0;
    ++compared;
  }
  RecordProperty("furthest_dps", std::to_string(furthest_dps));
  EXPECT_GT(compared, 30);
  EXPECT_GT(different, compared / 2) << "it is the same network twice";
  EXPECT_LE(furthest_dps, 0.1);
}

}  // namespace
}  // namespace thermorig::live
