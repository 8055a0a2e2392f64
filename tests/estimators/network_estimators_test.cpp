// SPDX-License-Identifier: MIT
// The network's estimators say what network::Estimator says of the same window, bit for bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "hand_made.h"
#include "thermorig/network/estimator.h"
#include "thermorig/network/scaling.h"
#include "thermorig/network/window_index.h"

namespace thermorig::estimators {
namespace {

std::vector<Measurement> two_seconds() {
  return measurements_of(HandMadeRig{.duration_s = 2.0, .gyro_dps = [](double time_s) {
                                       return static_cast<float>(30.0 * std::sin(time_s));
                                     }});
}

/// The window that ends with the frame, as training prepares it.
std::vector<float> window_of(const std::vector<Measurement>& run, std::size_t last,
                             const model::Model& model) {
  const network::Shape& shape = model.weights.shape;
  std::vector<float> window, prepared(shape.pixels());
  for (std::size_t i = last + 1 - static_cast<std::size_t>(shape.frames); i <= last; ++i) {
    network::prepare_frame(run[i].frame.frame.temp_c, shape, model.scaling, prepared);
    window.insert(window.end(), prepared.begin(), prepared.end());
  }
  return window;
}

float mean_gyro_dps(const std::vector<Measurement>& run, std::size_t last, int frames) {
  std::vector<float> rates_dps;
  for (std::size_t i = last + 1 - static_cast<std::size_t>(frames); i <= last; ++i)
    rates_dps.push_back(run[i].sample.rate_gyro_dps);
  return network::mean_rate(rates_dps);
}

class OfAShape : public testing::TestWithParam<network::Shape> {};

TEST_P(OfAShape, CnnThermalAndCnnFusionAreTheNetworksOutput) {
  const model::Model model = untrained_model(GetParam());
  const int frames = GetParam().frames;
  const auto run = two_seconds();
  network::Estimator network(model.weights);
  Bank bank(std::vector<std::string>{"cnn-thermal", "cnn-fusion"}, model, {});
  const auto estimates = all_estimates_of(bank, run);
  for (std::size_t last = 0; last < run.size(); ++last) {
    const auto& [thermal, fusion] = std::pair(estimates[last][0], estimates[last][1]);
    if (last + 1 < static_cast<std::size_t>(frames)) {
      EXPECT_EQ(thermal.reason, EstimateReason::window_incomplete);
      EXPECT_EQ(fusion.state, EstimateState::absent);
      continue;
    }
    const float gyro = mean_gyro_dps(run, last, frames) / 150.0F;
    const network::Output output = network.estimate(window_of(run, last, model), gyro);
    EXPECT_EQ(thermal.rate_dps, output.thermal * 150.0F);
    EXPECT_EQ(fusion.rate_dps, output.fusion * 150.0F);
    EXPECT_EQ(fusion.rate_dps, network::fusion_of(output, gyro) * 150.0F);
    EXPECT_EQ(fusion.values[0], output.gain);
    EXPECT_EQ(thermal.state, EstimateState::good);
    EXPECT_TRUE(std::isnan(thermal.rate_sigma_dps) && std::isnan(fusion.rate_sigma_dps));
  }
}

INSTANTIATE_TEST_SUITE_P(Networks, OfAShape,
                         testing::Values(network::Shape{.frames = 3, .reduction = 1},
                                         network::Shape{.frames = 2, .reduction = 3, .crop_left = 1}),
                         [](const auto& test) { return "Nf" + std::to_string(test.param.frames); });

TEST(CnnThermal, CountsItsAngleFromItsRates) {
  const auto run = two_seconds();
  Bank bank = bank_of("cnn-thermal", {}, untrained_model());
  const auto estimates = estimates_of(bank, run);
  double angle_deg = 0.0;
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    if (i >= 2) angle_deg += double{estimates[i].rate_dps} * 0.125;
    EXPECT_DOUBLE_EQ(estimates[i].angle_deg, angle_deg);
  }
  EXPECT_GT(std::abs(angle_deg), 0.1);
}

/// A run in which one frame is spoilt.
struct SpoiltRun {
  static constexpr std::size_t spoilt = 6;
  std::vector<Measurement> measurements = two_seconds();
  TimedFrame& frame() { return measurements[spoilt].frame; }
  std::vector<std::vector<RateEstimate>> estimates() const {
    Bank bank(std::vector<std::string>{"cnn-thermal", "cnn-fusion"}, untrained_model(), {});
    return all_estimates_of(bank, measurements);
  }
};

TEST(TheNetworksEstimators, SayNothingOfAWindowThatAFrameWithoutAnImageIsIn) {
  SpoiltRun run;
  run.frame().stands_in = true;
  run.frame().frame.temp_c.fill(std::numeric_limits<float>::quiet_NaN());
  const auto estimates = run.estimates();
  EXPECT_EQ(estimates[run.spoilt][0].reason, EstimateReason::no_image);
  for (std::size_t i = run.spoilt; i < run.spoilt + 3; ++i) {
    EXPECT_EQ(estimates[i][0].state, EstimateState::absent);
    EXPECT_EQ(estimates[i][1].state, EstimateState::absent);
  }
  EXPECT_EQ(estimates[run.spoilt + 1][0].reason, EstimateReason::window_incomplete);
  EXPECT_EQ(estimates[run.spoilt + 3][0].state, EstimateState::good);
}

TEST(TheNetworksEstimators, BeginAWindowAnewAfterFramesWereLost) {
  SpoiltRun run;
  run.frame().missing_before = 1;
  const auto estimates = run.estimates();
  EXPECT_EQ(estimates[run.spoilt][0].reason, EstimateReason::window_incomplete);
  EXPECT_EQ(estimates[run.spoilt + 1][0].state, EstimateState::absent);
  EXPECT_EQ(estimates[run.spoilt + 2][0].state, EstimateState::good);
}

TEST(CnnFusion, NeedsTheGyroOfEachFrameOfItsWindow) {
  for (const float wrong : {std::numeric_limits<float>::quiet_NaN(), 1e30F}) {
    SpoiltRun run;
    run.measurements[run.spoilt].sample.rate_gyro_dps = wrong;
    const auto estimates = run.estimates();
    for (std::size_t i = run.spoilt; i < run.spoilt + 3; ++i) {
      EXPECT_EQ(estimates[i][0].state, EstimateState::good);
      EXPECT_EQ(estimates[i][1].reason, EstimateReason::no_gyro);
    }
    EXPECT_EQ(estimates[run.spoilt + 3][1].state, EstimateState::good);
  }
}

/// The rate and so on of the last frame.
RateEstimate last_of(Bank& bank, const std::vector<Measurement>& run) {
  return all_estimates_of(bank, run).back().front();
}

Bank bank_with_sigma(const std::string& name, NetworkRun run = {}, bool mirrored = true) {
  RigProfile profile;
  profile.camera.mirrored = mirrored;
  model::Model model = untrained_model_with_sigma();
  model.provenance.view = network::CameraView();
  return {std::vector{name}, model, profile, run};
}

void mirror(std::vector<Measurement>& run) {
  for (Measurement& measurement : run) {
    auto& temp_c = measurement.frame.frame.temp_c;
    for (auto row = temp_c.begin(); row != temp_c.end(); row += frame_columns)
      std::reverse(row, row + frame_columns);
  }
}

TEST(CnnFusionKalman, LeavesTheRateToAGyroWhoseBiasARestHasShown) {
  HandMadeRig rig = rest_and_speed(4.0, 40.0, 7.0);
  rig.duration_s = 12.0;
  const auto run = measurements_of(rig);
  Bank fusion = bank_with_sigma("cnn-fusion-kalman"), gyro = bank_with_sigma("gyro-kalman");
  const RateEstimate fused = last_of(fusion, run), alone = last_of(gyro, run);
  EXPECT_NEAR(alone.rate_dps, 40.0F, 0.2F);
  EXPECT_NEAR(fused.rate_dps, alone.rate_dps, 0.02F);
  EXPECT_LT(fused.values[0], 0.001F);
  EXPECT_NEAR(fused.rate_sigma_dps, alone.rate_sigma_dps, 0.02F);
}

TEST(CnnFusionKalman, ListensToTheImagesBeforeThat) {
  const auto run = measurements_of(HandMadeRig{.duration_s = 2.0,
                                               .gyro_dps = [](double) { return 47.0F; },
                                               .is_told_to_move = [](double) { return true; }});
  Bank fusion = bank_with_sigma("cnn-fusion-kalman"), thermal = bank_with_sigma("cnn-thermal"),
       gyro = bank_with_sigma("gyro-kalman");
  const RateEstimate fused = last_of(fusion, run), images = last_of(thermal, run), alone = last_of(gyro, run);
  const float gain = fused.values[0];
  EXPECT_GT(gain, 0.1F);
  EXPECT_NEAR(fused.rate_dps, gain * images.rate_dps + (1.0F - gain) * alone.rate_dps, 1e-3F);
  EXPECT_LT(fused.rate_sigma_dps, images.rate_sigma_dps);
  EXPECT_LT(fused.rate_sigma_dps, alone.rate_sigma_dps);
}

TEST(TheNetworksEstimators, OfEightTurnsSayTheOppositeOfAMirroredScene) {
  auto run = two_seconds();
  Bank bank = bank_with_sigma("cnn-thermal", {.turned = 8});
  const float rate_dps = last_of(bank, run).rate_dps;
  mirror(run);
  Bank mirrored = bank_with_sigma("cnn-thermal", {.turned = 8});
  EXPECT_GT(std::abs(rate_dps), 0.01F);
  EXPECT_NEAR(last_of(mirrored, run).rate_dps, -rate_dps, 1e-3F);
}

TEST(TheNetworksEstimators, MirrorTheFramesOfACameraOfTheOtherOrientation) {
  auto run = two_seconds();
  Bank bank = bank_with_sigma("cnn-thermal");
  const float rate_dps = last_of(bank, run).rate_dps;
  mirror(run);
  Bank other = bank_with_sigma("cnn-thermal", {}, false);
  EXPECT_EQ(last_of(other, run).rate_dps, rate_dps);
}

}  // namespace
}  // namespace thermorig::estimators
