// SPDX-License-Identifier: MIT
// What the estimators state of their own errors, held against what simulated rigs really did.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <tuple>

#include "simulated_run.h"
#include "support/at_s.h"

namespace thermorig::estimators {
namespace {

/// Errors of one quantity, and the sigmas that were stated with them.
class StatedErrors {
 public:
  void add(double error, double sigma) {
    if (!std::isfinite(error) || !std::isfinite(sigma)) return;
    squares_ += error * error;
    covered_ += std::abs(error) <= 3.0 * sigma ? 1 : 0;
    sigmas_.push_back(sigma);
  }
  std::size_t count() const { return sigmas_.size(); }
  double rms() const { return std::sqrt(squares_ / static_cast<double>(count())); }
  double coverage() const { return static_cast<double>(covered_) / static_cast<double>(count()); }
  double median_sigma() const {
    std::vector<double> sorted = sigmas_;
    std::sort(sorted.begin(), sorted.end());
    return sorted[sorted.size() / 2];
  }

 private:
  double squares_ = 0.0;
  std::size_t covered_ = 0;
  std::vector<double> sigmas_;
};

const std::vector<std::string> gyro_estimators{"gyro", "gyro-rest", "gyro-kalman"};
constexpr std::size_t of_kalman = 2;

struct Errors {
  StatedErrors rate;      // of valid frames: over the exposure as the program knows it
  StatedErrors exposure;  // of valid frames: over the exposure as it was, the camera's time included
  StatedErrors any_rate;  // of all frames: ramps and rests included
  StatedErrors angle;     // of valid frames
};
using ErrorsOfAll = std::array<Errors, 3>;

void judge(const pipeline::VirtualSweep& sweep, ErrorsOfAll& errors) {
  const ShaftTruth truth(sweep.shaft);
  Bank bank(gyro_estimators, std::nullopt, sweep.config.profile);
  for (const Measurement& measurement : measurements_of(sweep)) {
    const TimedFrame& frame = measurement.frame;
    const double rate_dps = truth.mean_rate_dps(frame.exposure_begin, frame.exposure_end);
    const double sent_dps = sweep.frames.at(measurement.sample.frame_index).mean_rate_dps;
    const double angle_deg = truth.angle_deg(frame.exposure_end) - truth.angle_deg(HostTime{});
    const auto estimates = bank.add(measurement);
    for (std::size_t i = 0; i < estimates.size(); ++i) {
      const RateEstimate& one = estimates[i];
      errors[i].any_rate.add(one.rate_dps - rate_dps, one.rate_sigma_dps);
      if (!measurement.sample.valid) continue;
      errors[i].rate.add(one.rate_dps - rate_dps, one.rate_sigma_dps);
      errors[i].exposure.add(one.rate_dps - sent_dps, one.rate_sigma_dps);
      errors[i].angle.add(one.angle_deg - angle_deg, one.angle_sigma_deg);
    }
  }
}

class StatedSigmas : public testing::TestWithParam<std::tuple<simulation::GyroGrade, ServoKind>> {
 protected:
  void SetUp() override {
    const auto [grade, servo] = GetParam();
    for (std::uint64_t seed = 1; seed <= 20; ++seed)
      judge(pipeline::drive(rig_of(seed, grade, servo), six_legs(), six_legs_s), errors_);
  }

  ErrorsOfAll errors_;
};

TEST_P(StatedSigmas, CoverTheErrorsAndAreNotWideForNothing) {
  for (std::size_t i = 0; i < gyro_estimators.size(); ++i) {
    SCOPED_TRACE(gyro_estimators[i]);
    const auto& [rate, exposure, any_rate, angle] = errors_[i];
    EXPECT_GT(rate.count(), 4000U);
    EXPECT_EQ(angle.count(), rate.count());
    for (const StatedErrors* one : {&rate, &exposure, &any_rate, &angle}) EXPECT_GE(one->coverage(), 0.995);
    for (const StatedErrors* one : {&rate, &exposure, &angle})
      EXPECT_LE(one->median_sigma(), 2.0 * one->rms());
  }
}

std::string rig_name(const testing::TestParamInfo<StatedSigmas::ParamType>& rig) {
  const auto [grade, servo] = rig.param;
  const std::map<simulation::GyroGrade, std::string> grades{{simulation::GyroGrade::calibrated, "Calibrated"},
                                                            {simulation::GyroGrade::typical, "Typical"},
                                                            {simulation::GyroGrade::mpu6050_raw, "Raw"}};
  return grades.at(grade) + (servo == ServoKind::positional ? "OnAWinch" : "OnAContinuousServo");
}

INSTANTIATE_TEST_SUITE_P(OfAGyro, StatedSigmas,
                         testing::Combine(testing::Values(simulation::GyroGrade::calibrated,
                                                          simulation::GyroGrade::typical,
                                                          simulation::GyroGrade::mpu6050_raw),
                                          testing::Values(ServoKind::positional, ServoKind::continuous)),
                         rig_name);

void expect_covered(const ErrorsOfAll& errors) {
  for (std::size_t i = 0; i < gyro_estimators.size(); ++i) {
    SCOPED_TRACE(gyro_estimators[i]);
    EXPECT_GT(errors[i].any_rate.count(), 1000U);
    EXPECT_GE(errors[i].any_rate.coverage(), 0.995);
    EXPECT_GE(errors[i].angle.coverage(), 0.995);
  }
}

TEST(StatedSigmasOfATypicalGyro, CoverTheErrorsOfOneWhoseBytesAreLost) {
  ErrorsOfAll errors;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    auto config = rig_of(seed, simulation::GyroGrade::typical, ServoKind::positional);
    for (const auto& [begin_s, length_s] : {std::pair(14.0, 0.03), {22.0, 0.2}, {30.0, 1.0}, {38.0, 0.1}})
      config.outages.push_back({Device::gyro, at_s(begin_s), at_s(begin_s + length_s)});
    judge(pipeline::drive(config, six_legs(), six_legs_s), errors);
  }
  expect_covered(errors);
}

TEST(StatedSigmasOfATypicalGyro, CoverTheErrorsOfARigThatIsTurnedByHandAtRest) {
  ErrorsOfAll errors;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    auto config = rig_of(seed, simulation::GyroGrade::typical, ServoKind::positional);
    config.hand_turns = {{at_s(3.0), 5.0, 90.0}, {at_s(26.0), 10.0, -360.0}};
    judge(pipeline::drive(config, {{11.0, 6.0, 60.0}, {19.0, 6.0, -100.0}, {38.0, 6.0, 30.0}}, 46.0), errors);
  }
  expect_covered(errors);
}

TEST(StatedSigmasOfATypicalGyro, CoverTheErrorsOfOneThatSetsItselfToZeroAtRest) {
  ErrorsOfAll errors;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    auto config = rig_of(seed, simulation::GyroGrade::typical, ServoKind::continuous);
    config.gyro_zeroes_itself = true;
    judge(pipeline::drive(config, six_legs(), six_legs_s), errors);
  }
  EXPECT_EQ(errors[1].rate.count(), 0U);  // gyro-rest: no rest shows the bias
  EXPECT_GE(errors[of_kalman].rate.coverage(), 0.995);
  EXPECT_GE(errors[of_kalman].any_rate.coverage(), 0.995);
  EXPECT_GE(errors[of_kalman].angle.coverage(), 0.995);
}

}  // namespace
}  // namespace thermorig::estimators
