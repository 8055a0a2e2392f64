// SPDX-License-Identifier: MIT
#include "simulation/gyro.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "frame_statistics.h"
#include "thermorig/sensors/gyro_protocol.h"

namespace thermorig::simulation {
namespace {

std::vector<SimulatedGyroSample> samples_at(double rate_dps, const GyroProfile& profile, GyroGrade grade,
                                            std::uint64_t seed, double seconds) {
  Gyro gyro(profile, grade, seed);
  Shaft shaft(0.0);
  std::vector<SimulatedGyroSample> samples;
  double angle_deg = 0.0;
  for (std::int64_t ms = 0; ms < static_cast<std::int64_t>(seconds * 1000.0); ++ms) {
    for (int step = 0; step < 4; ++step) shaft.append(angle_deg += rate_dps * 1e-9 * Shaft::step_ns);
    for (auto& sample : gyro.follow(shaft)) samples.push_back(sample);
  }
  return samples;
}

std::vector<double> axis_of(const std::vector<SimulatedGyroSample>& samples, std::size_t axis) {
  std::vector<double> rates;
  for (const auto& sample : samples) rates.push_back(sample.rate_dps[axis]);
  return rates;
}

TEST(Gyro, SamplesAtItsRateWithoutAGap) {
  const auto samples = samples_at(0.0, {}, GyroGrade::typical, 1, 10.0);
  EXPECT_NEAR(static_cast<double>(samples.size()), 2000.0, 2.0);
  for (std::size_t i = 1; i < samples.size(); ++i)
    ASSERT_EQ(samples[i].begin.time_ns, samples[i - 1].end.time_ns);
}

TEST(Gyro, BiasSpreadsWithTheGrade) {
  const auto spread = [](GyroGrade grade) {
    std::vector<double> biases;
    for (std::uint64_t seed = 1; seed <= 60; ++seed)
      biases.push_back(mean_of(axis_of(samples_at(0.0, {}, grade, seed, 0.5), 2)));
    return deviation_of(biases);
  };
  EXPECT_NEAR(spread(GyroGrade::calibrated), 0.1, 0.04);
  EXPECT_NEAR(spread(GyroGrade::typical), 2.0, 0.6);
  EXPECT_NEAR(spread(GyroGrade::mpu6050_raw), 10.0, 3.0);
}

TEST(Gyro, NoiseOfARawMpu6050IsThatOfARealOne) {
  // Ten minutes of a real one at rest: standard deviations of 0.126, 0.091 and 0.113 deg/s.
  const auto rates = axis_of(samples_at(0.0, {}, GyroGrade::mpu6050_raw, 3, 10.0), 0);
  EXPECT_GT(deviation_of(rates), 0.08);
  EXPECT_LT(deviation_of(rates), 0.14);
}

TEST(Gyro, MeasuresTheRateOnItsAxisWithItsSign) {
  const GyroProfile upside_down{.axis = 1, .sign = -1};
  const auto turning = samples_at(100.0, upside_down, GyroGrade::calibrated, 4, 2.0);
  EXPECT_NEAR(mean_of(axis_of(turning, 1)), -100.0, 1.0);
  EXPECT_NEAR(mean_of(axis_of(turning, 0)), 0.0, 1.0);
}

TEST(Gyro, ScaleErrorStaysWithinAFewPercent) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const double gained = mean_of(axis_of(samples_at(200.0, {}, GyroGrade::typical, seed, 0.5), 2)) -
                          mean_of(axis_of(samples_at(0.0, {}, GyroGrade::typical, seed, 0.5), 2));
    EXPECT_NEAR(gained / 200.0, 1.0, 0.03);
    EXPECT_NE(gained, 200.0);
  }
}

TEST(Gyro, ClipsAtItsRange) {
  for (const double rate : axis_of(samples_at(400.0, {}, GyroGrade::mpu6050_raw, 1, 0.2), 2))
    EXPECT_NEAR(rate, 250.0, 1.0 / 131.0);
}

TEST(Gyro, AveragesOverItsIntervalInsteadOfSampling) {
  Gyro gyro({.output_rate_hz = 50.0}, GyroGrade::calibrated, 2);
  Shaft shaft(0.0);
  std::vector<double> rates;
  for (int step = 0; step < 8000; ++step) {  // a 200 Hz jitter of 100 deg/s, 2 s long
    const double time_s = 1e-9 * Shaft::step_ns * step;
    shaft.append(100.0 / (2.0 * M_PI * 200.0) * std::sin(2.0 * M_PI * 200.0 * time_s));
    if (step % 4 == 0)
      for (const auto& sample : gyro.follow(shaft)) rates.push_back(sample.rate_dps[2]);
  }
  EXPECT_LT(deviation_of(rates), 1.0);
}

TEST(GyroBytes, OfAWitmotionComeBackAsTheSameRates) {
  const GyroProfile profile;
  sensors::GyroScanner scanner = sensors::gyro_scanner(profile);
  std::vector<wire::GyroMessage> messages;
  const auto samples = samples_at(150.0, profile, GyroGrade::typical, 1, 1.0);
  for (const auto& sample : samples) scanner.push(gyro_encoder(profile).bytes(sample, profile), messages);
  ASSERT_EQ(messages.size(), samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i)
    EXPECT_NEAR(messages[i].reading.rate_dps[2], samples[i].rate_dps[2], 1e-3);
}

TEST(GyroBytes, OfATextGyroComeBackInTheProfilesColumns) {
  const GyroProfile profile{
      .protocol = "text",
      .text = {.prefix = "a/g:", .rate = {3, 4, 5}, .scale_dps = 1.0 / 131.0, .time = 6, .time_unit_s = 1e-3},
      .output_rate_hz = 100.0};
  sensors::GyroScanner scanner = sensors::gyro_scanner(profile);
  std::vector<wire::GyroMessage> messages;
  const auto samples = samples_at(-60.0, profile, GyroGrade::mpu6050_raw, 1, 1.0);
  for (const auto& sample : samples) scanner.push(gyro_encoder(profile).bytes(sample, profile), messages);
  ASSERT_EQ(messages.size(), samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    EXPECT_NEAR(messages[i].reading.rate_dps[2], samples[i].rate_dps[2], 1e-3);
    ASSERT_TRUE(messages[i].reading.device_time_us.has_value());
    EXPECT_EQ(*messages[i].reading.device_time_us, samples[i].device_time_us);
  }
}

/// `tolerance_dps`: half of the message's step. `step_us`: of its time.
void expect_mavlink_comes_back(const std::map<std::string, double>& settings, double tolerance_dps,
                               std::int64_t step_us) {
  const GyroProfile profile{.protocol = "mavlink", .settings = settings, .output_rate_hz = 100.0};
  sensors::GyroScanner scanner = sensors::gyro_scanner(profile);
  std::vector<wire::GyroMessage> messages;
  const auto samples = samples_at(-60.0, profile, GyroGrade::typical, 1, 3.0);
  for (const auto& sample : samples) scanner.push(gyro_encoder(profile).bytes(sample, profile), messages);
  EXPECT_EQ(scanner.counters().replies, 3U);  // a heartbeat a second
  EXPECT_EQ(scanner.counters().lost, 0U);
  ASSERT_EQ(messages.size(), samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const GyroReading& reading = messages[i].reading;
    for (std::size_t axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(reading.rate_dps[axis], samples[i].rate_dps[axis], tolerance_dps);
    EXPECT_EQ(reading.device_time_us, samples[i].device_time_us / step_us * step_us);
    ASSERT_TRUE(reading.temp_c.has_value());
    EXPECT_NEAR(*reading.temp_c, samples[i].temp_c, 0.006);
  }
}

TEST(GyroBytes, OfAFlightControllerComeBackInEachOfItsMessages) {
  expect_mavlink_comes_back({}, 0.0287, 1000);  // SCALED_IMU: mrad/s, ms
  expect_mavlink_comes_back({{"message", 105.0}}, 1e-4, 1);
  expect_mavlink_comes_back({{"raw_scale_dps", 0.01}}, 0.0051, 1);
  expect_mavlink_comes_back({{"system", 7.0}, {"component", 200.0}}, 0.0287, 1000);
}

}  // namespace
}  // namespace thermorig::simulation
