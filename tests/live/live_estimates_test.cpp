// SPDX-License-Identifier: MIT
#include "thermorig/estimators/live/live_estimates.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "../network/allocations.h"
#include "../support/paper_estimates.h"
#include "../support/same_row.h"
#include "causal_run.h"
#include "thermorig/learning/training/prediction.h"
#include "thermorig/network/estimator.h"
#include "thermorig/network/window_index.h"

namespace thermorig::live {
namespace {

/// One run for all tests: nothing in it changes.
const std::vector<CausalMeasurement>& run() {
  static const std::vector<CausalMeasurement> measurements = measurements_of(two_legs());
  return measurements;
}

model::Model model_of(const network::Shape& shape) {
  return model_for(acquisition_of(run()), shape);
}

bool has_thermal(const EstimateRow& row) {
  return std::isfinite(thermal_dps(row));
}
bool has_fusion(const EstimateRow& row) {
  return std::isfinite(fusion_dps(row)) && std::isfinite(kg(row));
}

class LiveRows : public testing::TestWithParam<network::Shape> {};

TEST_P(LiveRows, AreCountedWhereTrainingFindsAWindow) {
  const network::Acquisition acquisition = acquisition_of(run());
  const auto rows = rows_of(run(), model_of(GetParam()));
  std::vector<network::Window> counted;
  for (const EstimateRow& row : rows)
    if (row.counted) counted.push_back({0, row.frame_index});
  EXPECT_EQ(counted, network::find_windows({&acquisition, 1}, GetParam().frames));
  EXPECT_GT(counted.size(), 30U);
  EXPECT_LT(counted.size(), rows.size());
}

TEST_P(LiveRows, SayOfAWindowWhatThePredictionSays) {
  const network::Acquisition acquisition = acquisition_of(run());
  const model::Model model = model_of(GetParam());
  const auto rows = rows_of(run(), model);
  const auto found = network::find_windows({&acquisition, 1}, GetParam().frames);
  for (const training::WindowEstimate& window : training::predict(model, {&acquisition, 1}, found)) {
    const EstimateRow& row = rows[window.window.last];
    EXPECT_EQ(row.time, acquisition.time[window.window.last]);
    EXPECT_EQ(row.rate_commanded_dps, window.label_dps);
    EXPECT_EQ(gyro_dps(row), window.gyro_dps);
    EXPECT_NEAR(thermal_dps(row), window.thermal_dps, 0.01F);  // the batch's kernels sum in another order
    if (!GetParam().fusion) continue;
    EXPECT_NEAR(fusion_dps(row), window.fusion_dps, 0.01F);
    EXPECT_NEAR(kg(row), window.gain, 1e-4F);
  }
}

TEST_P(LiveRows, SayOfEveryCompleteWindowWhatTheEstimatorSaysBitForBit) {
  const network::Acquisition acquisition = acquisition_of(run());
  const model::Model model = model_of(GetParam());
  const auto prepared = network::prepare(acquisition, GetParam(), model.scaling);
  const auto frames = static_cast<std::size_t>(GetParam().frames);
  network::Estimator estimator(model.weights);
  const auto rows = rows_of(run(), model);
  std::size_t asked = 0;
  for (std::size_t last = 0; last < rows.size(); ++last) {
    EXPECT_EQ(has_thermal(rows[last]), last + 1 >= frames);
    if (!has_thermal(rows[last])) continue;
    const auto window =
        std::span(prepared).subspan((last + 1 - frames) * GetParam().pixels(), frames * GetParam().pixels());
    const network::Output output = estimator.estimate(window, gyro_dps(rows[last]) / 150.0F);
    EXPECT_EQ(thermal_dps(rows[last]), output.thermal * 150.0F);
    EXPECT_EQ(has_fusion(rows[last]), GetParam().fusion && std::isfinite(gyro_dps(rows[last])));
    if (has_fusion(rows[last])) {
      EXPECT_EQ(fusion_dps(rows[last]), output.fusion * 150.0F);
    }
    ++asked;
  }
  EXPECT_GT(asked, 100U);
}

INSTANTIATE_TEST_SUITE_P(OfAnyShape, LiveRows,
                         testing::Values(network::Shape{.frames = 3, .reduction = 1},
                                         network::Shape{.frames = 2, .reduction = 3, .crop_left = 1},
                                         network::Shape{.frames = 6, .reduction = 2, .fusion = false}),
                         [](const auto& test) {
                           return "Nf" + std::to_string(test.param.frames) + "Nr" +
                                  std::to_string(test.param.reduction);
                         });

TEST(LiveEstimates, TellsTheFramesTimesAndReasonsAsTheSampleHasThem) {
  const auto rows = rows_of(run(), model_of({}));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto& [measurement, arrived] = run()[i];
    const LabelledSample& sample = measurement.sample;
    EXPECT_EQ(rows[i].frame_index, i);
    EXPECT_EQ(rows[i].time, sample.time);
    EXPECT_EQ(rows[i].exposure_begin, sample.exposure_begin);
    EXPECT_EQ(rows[i].exposure_end, sample.exposure_end);
    EXPECT_EQ(rows[i].arrival, arrived);
    EXPECT_EQ(rows[i].reason_bits, sample.reason_bits);
    EXPECT_EQ(rows[i].run, sample.run);
    EXPECT_EQ(rows[i].leg, sample.leg);
  }
}

TEST(LiveEstimates, WithoutANetworkHoldsTheGyroOfEachFrameAgainstItsLabel) {
  const auto rows = rows_of(run(), std::nullopt);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const LabelledSample& sample = run()[i].measurement.sample;
    EXPECT_TRUE(same_bits(rows[i].rate_commanded_dps, sample.rate_commanded_dps));
    EXPECT_TRUE(same_bits(gyro_dps(rows[i]), sample.rate_gyro_dps));
    EXPECT_FALSE(has_thermal(rows[i]) || has_fusion(rows[i]));
    EXPECT_EQ(rows[i].counted, sample.valid);
  }
}

TEST(LiveEstimates, AsksForNoMemoryFrameByFrame) {
  LiveEstimates estimator(paper_bank(model_of({})));
  const std::size_t before = allocations();
  for (const auto& [measurement, arrived] : run()) estimator.add(measurement, arrived);
  EXPECT_EQ(allocations(), before);
}

TEST(LiveEstimates, GivesTheSameRowsAgainBitForBit) {
  EXPECT_TRUE(same_rows(rows_of(run(), model_of({})), rows_of(run(), model_of({}))));
}

/// Angles remember what was before.
bool same_rates(const EstimateRow& a, const EstimateRow& b) {
  return same_bits(gyro_dps(a), gyro_dps(b)) && same_bits(thermal_dps(a), thermal_dps(b)) &&
         same_bits(fusion_dps(a), fusion_dps(b)) && same_bits(kg(a), kg(b)) && a.counted == b.counted;
}

/// A counted frame with counted ones on both sides, and the run with that frame changed.
class AChangedFrame : public testing::Test {
 protected:
  std::size_t place() const {
    const auto rows = rows_of(run(), model_);
    for (std::size_t i = 0; i + 8 < rows.size(); ++i)
      if (rows[i].counted && rows[i + 8].counted && rows[i].run == rows[i + 8].run) return i + 3;
    return 0;
  }
  std::vector<EstimateRow> rows() const { return rows_of(measurements_, model_); }

  model::Model model_ = model_of({.frames = 3, .reduction = 2});
  std::vector<CausalMeasurement> measurements_ = run();
  std::size_t place_ = place();
};

TEST_F(AChangedFrame, WithoutGyroLeavesTheThermalHeadAlone) {
  measurements_[place_].measurement.sample.rate_gyro_dps = unknown_dps;
  const auto changed = rows(), as_it_was = rows_of(run(), model_);
  for (std::size_t i = place_; i < place_ + 3; ++i) {
    EXPECT_EQ(thermal_dps(changed[i]), thermal_dps(as_it_was[i]));
    EXPECT_FALSE(has_fusion(changed[i]));
    EXPECT_TRUE(std::isnan(gyro_dps(changed[i])));
    EXPECT_FALSE(changed[i].counted);
  }
  EXPECT_TRUE(same_rates(changed[place_ + 3], as_it_was[place_ + 3]));
}

TEST_F(AChangedFrame, WithoutALabelIsEstimatedButNotCounted) {
  measurements_[place_].measurement.sample.rate_commanded_dps = unknown_dps;
  const auto changed = rows();
  for (std::size_t i = place_; i < place_ + 3; ++i) {
    EXPECT_TRUE(has_thermal(changed[i]) && has_fusion(changed[i]));
    EXPECT_FALSE(changed[i].counted);
  }
  EXPECT_TRUE(changed[place_ + 3].counted);
}

TEST_F(AChangedFrame, AfterAGapBeginsAWindowOfItsOwn) {
  measurements_[place_].measurement.frame.missing_before = 1;
  const auto changed = rows();
  EXPECT_FALSE(has_thermal(changed[place_]));
  EXPECT_FALSE(has_thermal(changed[place_ + 1]));
  EXPECT_TRUE(has_thermal(changed[place_ + 2]));
  EXPECT_FALSE(changed[place_].counted || changed[place_ + 1].counted);
  EXPECT_TRUE(same_rates(changed[place_ + 2], rows_of(run(), model_)[place_ + 2]));
}

TEST_F(AChangedFrame, AfterDamagedBytesBeginsAWindowOfItsOwn) {
  measurements_[place_].measurement.frame.resync_before = true;
  const auto changed = rows();
  EXPECT_FALSE(has_thermal(changed[place_]) || has_thermal(changed[place_ + 1]));
  EXPECT_TRUE(has_thermal(changed[place_ + 2]));
}

TEST_F(AChangedFrame, WithAPixelThatIsNoTemperatureIsInNoWindow) {
  for (const float wrong : {unknown_dps, 1000.0F, std::numeric_limits<float>::infinity()}) {
    measurements_[place_].measurement.frame.frame.temp_c[7] = wrong;
    const auto changed = rows();
    for (std::size_t i = place_; i < place_ + 3; ++i) {
      EXPECT_FALSE(has_thermal(changed[i]));
      EXPECT_FALSE(changed[i].counted);
    }
    EXPECT_TRUE(changed[place_ + 3].counted);
  }
}

}  // namespace
}  // namespace thermorig::live
