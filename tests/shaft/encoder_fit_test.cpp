// SPDX-License-Identifier: MIT
#include "thermorig/fit/shaft/encoder_fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace thermorig::fit {

namespace {

using ::testing::HasSubstr;

constexpr double rad = std::numbers::pi / 180.0;
constexpr int steps_a_leg = 800;  // of 5 ms
constexpr int resting_steps = 100;

/// Legs there and back, at rest between them, seen by a servo's telemetry, a gyro with errors, and a sensor
/// on the shaft whose magnet sits off the axis.
struct MeasuredLegs {
  double speed_dps = 150.0;
  int legs = 8;
  double direction = -1.0;
  double turns_by = 1.0;  // of the sensor for each degree of the shaft
  double once_deg = 1.2, twice_deg = 0.3;
  std::vector<TimedServo> servo;
  std::vector<TimedGyro> gyro;
  std::vector<TimedShaft> shaft;

  double sent_deg(double angle_deg) const {
    const double turned = direction * turns_by * angle_deg + 77.0;
    return turned + once_deg * std::sin(rad * turned + 0.5) + twice_deg * std::sin(2.0 * rad * turned - 1.0);
  }

  MeasuredLegs& run(const EncoderProfile& profile = {}) {
    std::mt19937 random(3);
    std::normal_distribution<double> noise;
    double angle_deg = 0.0;
    for (int step = 0; step < legs * steps_a_leg; ++step) {
      const double t = 0.005 * step;
      const int leg = step / steps_a_leg;
      const bool moves = step % steps_a_leg >= resting_steps;
      const double rate_dps = moves ? (leg % 2 == 0 ? speed_dps : -speed_dps) : 0.0;
      angle_deg += 0.005 * rate_dps;
      TimedGyro sample;
      sample.stamp.time = HostTime(from_s(t - 0.0025));
      sample.rate_dps = static_cast<float>(1.02 * rate_dps + 0.7 + 0.1 * noise(random));
      gyro.push_back(sample);
      TimedShaft reading;
      reading.stamp.time = HostTime(from_s(t));
      reading.mcu_time_us = 5000LL * step;
      const double sent = sent_deg(angle_deg) + 0.05 * noise(random);
      reading.reading.angle_deg = sent - 360.0 * std::floor(sent / 360.0);
      reading.reading.uncertainty_deg = 0.05F;
      reading.angle_deg = profile.angle_deg(sent);
      shaft.push_back(reading);
      if (step % 2 != 0) continue;
      TimedServo state;
      state.stamp.time = HostTime(from_s(t));
      state.mcu_time_us = 5000LL * step;
      state.state = {.angle_deg = angle_deg,
                     .rate_dps = rate_dps,
                     .motion = rate_dps == 0.0 ? ServoMotion::holding : ServoMotion::steady,
                     .leg = static_cast<std::uint16_t>(rate_dps == 0.0 ? 0 : leg + 1)};
      servo.push_back(state);
    }
    return *this;
  }

  EncoderFitResult fit() const { return fit_encoder(shaft, gyro, servo, errors(), {}); }

  ShaftReport judged(const EncoderProfile& encoder) const {
    RigProfile profile;
    profile.encoder = encoder;
    return judge_shaft(shaft, gyro, servo, errors(), profile, {});
  }

  static GyroErrors errors() {
    GyroErrors errors;
    errors.bias_dps = Estimate{0.5, 0.1};
    return errors;
  }
};

EncoderProfile calibrated(const MeasuredLegs& legs) {
  EncoderProfile encoder = legs.fit().fit.value().encoder;
  encoder.measured_utc = "2026-07-25T14:35:12Z";
  return encoder;
}

TEST(EncoderFit, FindsDirectionAndErrorsOfAMagnetOffTheAxis) {
  const MeasuredLegs legs = MeasuredLegs().run();
  const auto found = legs.fit();
  ASSERT_TRUE(found.fit) << found.why_not;
  const EncoderFit& fit = *found.fit;
  EXPECT_EQ(fit.encoder.sign, -1);
  EXPECT_NEAR(fit.once_deg, 1.2, 0.03);
  EXPECT_NEAR(fit.twice_deg, 0.3, 0.03);
  EXPECT_NEAR(fit.noise_deg, 0.05, 0.005);
  EXPECT_LT(fit.encoder.error_deg, 0.03);
  for (double angle_deg = -700.0; angle_deg < 700.0; angle_deg += 37.0)  // its errors, and its zero
    EXPECT_NEAR(std::remainder(fit.encoder.angle_deg(legs.sent_deg(angle_deg)) - angle_deg, 360.0), 0.0, 0.1);
}

TEST(EncoderFit, NeitherBiasNorScaleOfTheGyroAreInIt) {
  const auto found = MeasuredLegs().run().fit();
  ASSERT_TRUE(found.fit);
  EXPECT_NEAR(found.fit->gyro_share.value, 1.02, 0.005);  // though the gyro said nothing of it
  EXPECT_LT(found.fit->encoder.error_deg, 0.03);
}

TEST(EncoderFit, OfTooFewLegsItSaysSo) {
  MeasuredLegs legs;
  legs.legs = 2;
  const auto found = legs.run().fit();
  EXPECT_FALSE(found.fit);
  EXPECT_THAT(found.why_not, HasSubstr("2 legs"));
}

TEST(ShaftJudgement, ACalibratedSensorIsUsed) {
  const EncoderProfile encoder = calibrated(MeasuredLegs().run());
  const ShaftReport report = MeasuredLegs().run(encoder).judged(encoder);
  EXPECT_TRUE(report.used) << report.why_not;
  EXPECT_EQ(report.why_not, "");
  EXPECT_NEAR(report.command_share.value().value, 1.0, 0.002);
}

TEST(ShaftJudgement, OneThatNobodyCalibratedIsNot) {
  const ShaftReport report = MeasuredLegs().run().judged({});
  EXPECT_FALSE(report.used);
  EXPECT_THAT(report.why_not, HasSubstr("calibrate encoder"));
}

TEST(ShaftJudgement, WhatContradictsGyroAndCommandIsNamed) {
  const EncoderProfile encoder = calibrated(MeasuredLegs().run());
  const auto why_not = [&](auto change) {
    MeasuredLegs legs;
    change(legs);
    const ShaftReport report = legs.run(encoder).judged(encoder);
    EXPECT_FALSE(report.used);
    return report.why_not;
  };
  EXPECT_THAT(why_not([](MeasuredLegs& legs) { legs.turns_by = 0.0; }), HasSubstr("magnet loose"));
  EXPECT_THAT(why_not([](MeasuredLegs& legs) { legs.direction = 1.0; }), HasSubstr("direction"));
  EXPECT_THAT(why_not([](MeasuredLegs& legs) { legs.turns_by = 0.8; }), HasSubstr("slips"));
  EXPECT_THAT(why_not([](MeasuredLegs& legs) { legs.once_deg = 2.0; }), HasSubstr("has moved"));
}

TEST(ShaftJudgement, ASensorThatNeverAnswersIsNotUsed) {
  MeasuredLegs legs = MeasuredLegs().run();
  for (TimedShaft& reading : legs.shaft) {
    reading.reading.status = ShaftStatus::silent;
    reading.angle_deg = std::nan("");
  }
  const ShaftReport report = legs.judged(calibrated(MeasuredLegs().run()));
  EXPECT_FALSE(report.used);
  EXPECT_EQ(report.unread, report.readings);
  EXPECT_THAT(report.why_not, HasSubstr("did not answer"));
}

}  // namespace
}  // namespace thermorig::fit
