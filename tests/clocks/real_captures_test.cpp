// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <string>

#include "../support/captures.h"
#include "thermorig/fit/clocks/recorded_clock.h"

namespace thermorig::fit {

using namespace timing;

namespace {

/// Column `column` of a file with one line of headings, seconds.
std::vector<HostTime> times(const std::vector<std::uint8_t>& file, int column, double zero_s) {
  std::istringstream lines(std::string(file.begin(), file.end()));
  std::string line;
  std::getline(lines, line);
  std::vector<HostTime> result;
  while (std::getline(lines, line)) {
    std::istringstream cells(line);
    std::string cell;
    for (int i = 0; i <= column; ++i) std::getline(cells, cell, ',');
    result.push_back(HostTime(from_s(std::stod(cell) - zero_s)));
  }
  return result;
}

struct Fitted {
  std::vector<std::int64_t> number;
  ArrivalClock clock;
};

/// Each row is an arrival.
Fitted fit(const std::vector<HostTime>& arrived, const PortProfile& link, double nominal_rate_hz) {
  Fitted result{.number = number_messages(arrived, {}, nominal_rate_hz), .clock = {}};
  std::vector<double> device_s;
  std::vector<LatestBegin> latest;
  for (std::size_t i = 0; i < arrived.size(); ++i) {
    device_s.push_back(static_cast<double>(result.number[i]) / nominal_rate_hz);
    latest.push_back({device_s.back(), arrived[i]});
  }
  result.clock = fit_arrivals(device_s, latest, link, nominal_rate_hz);
  return result;
}

TEST(RealCaptures, ThePeriodOfTenMinutesOfMpu6050IsFoundInItsBursts) {
  const auto file =
      test::read_capture("mpu6050_usb_serial/set-2_unmoved-with-x-pointing-forward-10min_gyro.csv");
  if (!file) GTEST_SKIP() << "capture not on this machine";
  const auto arrived = times(*file, 0, 0.0);
  ASSERT_EQ(arrived.size(), 65067U);
  const Fitted fitted = fit(arrived, PortProfile{}, 100.0);
  EXPECT_EQ(fitted.number.back(), 65066);  // bursts of up to 85 samples, none lost

  // Independently: samples over time. Both ends are uncertain by a burst, half a second of 655.
  const double counted_hz = 65066.0 / to_s(arrived.back() - arrived.front());
  const ClockReport& report = fitted.clock.report;
  EXPECT_NEAR(report.rate_hz, counted_hz, 0.001 * counted_hz);
  RecordProperty("rate_hz", std::to_string(report.rate_hz));

  // Bursts come every 0.07 to 0.85 s: the median sample waits for a part of that, the last for longest.
  EXPECT_GT(report.late_p50_us, 20e3);
  EXPECT_LT(report.late_p50_us, 200e3);
  EXPECT_GT(report.late_p95_us, report.late_p50_us);
  EXPECT_LT(report.late_p95_us, 400e3);
  EXPECT_LT(report.late_max_us, 1000e3);
  EXPECT_TRUE(report.gaps.empty());
}

TEST(RealCaptures, TheMinutesOfTheMpu6050FileAgreeOnItsPeriod) {
  const auto file =
      test::read_capture("mpu6050_usb_serial/set-2_unmoved-with-x-pointing-forward-10min_gyro.csv");
  if (!file) GTEST_SKIP() << "capture not on this machine";
  const auto arrived = times(*file, 0, 0.0);
  const double whole_hz = fit(arrived, PortProfile{}, 100.0).clock.report.rate_hz;
  std::vector<double> minutes_hz;
  constexpr std::size_t minute = 6000;
  for (std::size_t begin = 0; begin + minute <= arrived.size(); begin += minute) {
    const std::vector<HostTime> part(arrived.begin() + static_cast<std::ptrdiff_t>(begin),
                                     arrived.begin() + static_cast<std::ptrdiff_t>(begin + minute));
    minutes_hz.push_back(fit(part, PortProfile{}, 100.0).clock.report.rate_hz);
    EXPECT_NEAR(minutes_hz.back(), whole_hz, 0.005 * whole_hz) << begin;  // a burst is 0.3 s of 60
  }
  std::sort(minutes_hz.begin(), minutes_hz.end());
  EXPECT_NEAR(minutes_hz[minutes_hz.size() / 2], whole_hz, 0.001 * whole_hz);
}

TEST(RealCaptures, AGyMcu90640SetToEightHertzDeliversFour) {
  const auto file = test::read_capture("gy_mcu90640_serial/roasted-duck.times.csv");
  if (!file) GTEST_SKIP() << "capture not on this machine";
  const auto arrived = times(*file, 1, 1577723699.0);
  const PortProfile link = CameraProfile{}.link;
  const double counted_hz = static_cast<double>(arrived.size() - 1) / to_s(arrived.back() - arrived.front());
  for (const double nominal_hz : {8.0, 4.0}) {
    const Fitted fitted = fit(arrived, link, nominal_hz);
    EXPECT_EQ(fitted.number.back(), static_cast<std::int64_t>(arrived.size()) - 1);
    EXPECT_NEAR(fitted.clock.report.rate_hz, counted_hz, 0.002 * counted_hz);
    EXPECT_LT(fitted.clock.report.late_max_us, 30e3);
  }
}

}  // namespace
}  // namespace thermorig::fit
