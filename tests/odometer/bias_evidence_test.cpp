// SPDX-License-Identifier: MIT
#include "estimators/odometer/bias_evidence.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace thermorig::odometer {
namespace {

constexpr double true_bias_dps = 7.0, true_scale = 1.012;

/// A search that names a bias, as the mosaic of a scale of 1 does.
void add_named(BiasEvidence& evidence, double named_dps, double read_dps) {
  std::vector<double> variances(121, 1.5);
  for (std::size_t i = 0; i < variances.size(); ++i) {
    const double off_dps = 0.5 * (static_cast<double>(i) - 60.0) - named_dps;
    if (off_dps * off_dps < 9.0) variances[i] = 1.0 + off_dps * off_dps / 18.0;
  }
  evidence.add({.variances = variances,
                .step_dps = 0.5,
                .read_dps = read_dps,
                .least = 1.0,
                .readings = 100.0 / BiasSearch::trusted_with_care,
                .is_distinct = true});
}

void add_right(BiasEvidence& evidence, double turned_dps) {
  add_named(evidence, true_bias_dps + (true_scale - 1.0) * turned_dps,
            true_bias_dps + true_scale * turned_dps);
}

constexpr std::array<double, 6> speeds_dps{150.0, -150.0, 40.0, -60.0, 120.0, -180.0};

void expect_right(const BiasEvidence& evidence) {
  ASSERT_TRUE(evidence.found());
  EXPECT_NEAR(evidence.found()->bias_dps, true_bias_dps, 0.5);
  EXPECT_NEAR(evidence.found()->scale, true_scale, 0.004);
}

TEST(BiasEvidence, TellsScaleFromBiasBySearchesAtSeveralSpeeds) {
  BiasEvidence evidence{Priors()};
  for (const double speed_dps : speeds_dps) add_right(evidence, speed_dps);
  expect_right(evidence);
}

TEST(BiasEvidence, OutvotesSearchesThatNameAWrongBiasEachTime) {
  BiasEvidence evidence{Priors()};
  for (std::size_t i = 0; i < speeds_dps.size(); ++i) {
    add_right(evidence, speeds_dps[i]);
    add_named(evidence, -25.0 + 9.0 * static_cast<double>(i), speeds_dps[i]);
  }
  expect_right(evidence);
}

TEST(BiasEvidence, SaysNothingWhereASearchStandsAlone) {
  BiasEvidence evidence{Priors()};
  add_right(evidence, 150.0);
  EXPECT_FALSE(evidence.found());
}

TEST(BiasEvidence, SaysNothingWhereSearchesContradictEachOther) {
  BiasEvidence evidence{Priors()};
  for (const double named_dps : {-20.0, 5.0, 25.0}) add_named(evidence, named_dps, 30.0);
  EXPECT_FALSE(evidence.found());
}

TEST(BiasEvidence, ForgetsAll) {
  BiasEvidence evidence{Priors()};
  for (const double speed_dps : speeds_dps) add_right(evidence, speed_dps);
  evidence.clear();
  EXPECT_FALSE(evidence.found());
}

}  // namespace
}  // namespace thermorig::odometer
