// SPDX-License-Identifier: MIT
#include "fit/clock_fits.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "thermorig/pipeline/timing/link_timing.h"

namespace thermorig::fit {

using namespace pipeline;

namespace {

constexpr std::size_t message_bytes = 20;
constexpr double wire_s = 10.0 * message_bytes / 115200.0;

/// A gyro at 200 samples a second, read up to 8 ms late; its own clock runs 1 % fast.
struct GyroStream {
  RawStream received;
  std::vector<TimedGyro> gyro;

  void add(double begin_s, double delay_s, std::optional<double> own_s) {
    const HostTime arrival(from_s(begin_s + wire_s + delay_s));
    TimedGyro sample;
    sample.span = {received.bytes.size(), received.bytes.size() + message_bytes};
    sample.stamp = {.time = arrival - from_s(wire_s), .arrival = arrival};
    if (own_s) sample.reading.device_time_us = std::llround(1e6 * *own_s);
    received.append(std::vector<std::uint8_t>(message_bytes), arrival);
    gyro.push_back(sample);
  }
};

GyroStream stream_of(int samples, double own_unit_s = 1.0) {
  std::mt19937 random(2);
  GyroStream stream;
  double read_s = 0.0;
  for (int i = 0; i < samples; ++i) {
    const double begin_s = 0.005 * i;
    read_s = std::max(read_s, begin_s + 0.0001 + 8e-6 * static_cast<double>(random() % 1000));
    stream.add(begin_s, read_s - begin_s, (7.0 + 1.01 * begin_s) / own_unit_s);
  }
  return stream;
}

/// Of lines of text, the time in their first column.
GyroProfile profile() {
  GyroProfile gyro{.protocol = "text"};
  gyro.text.time = 0;
  gyro.link.baud = 115200;
  return gyro;
}

double worst_error_s(const ClockFit& fit) {
  double worst = 0.0;
  for (std::size_t i = 0; i < fit.times.size(); ++i)
    worst = std::max(worst,
                     std::abs(to_s(fit.times[i].time.time_since_epoch()) - 0.005 * static_cast<double>(i)));
  return worst;
}

TEST(GyroClock, GoesByTheGyrosOwnTimeWhereItSendsOne) {
  const GyroStream stream = stream_of(4000);
  const ClockFit fit = fit_gyro_clock(stream.received, stream.gyro, profile());
  ASSERT_EQ(fit.times.size(), 4000U);
  EXPECT_LT(worst_error_s(fit), 0.002);
  EXPECT_NEAR(fit.report.skew_ppm, -1e6 * 0.01 / 1.01, 50.0);  // fast
}

/// Samples that lie in the gyro's FIFO until ten are there, and are then printed in a row.
GyroStream batches_of(int samples, double print_s) {
  GyroStream stream;
  for (int i = 0; i < samples; ++i) {
    const double read_s = 0.005 * (i / 10 * 10 + 9);
    const double begin_s = read_s + wire_s * (i % 10);
    stream.add(begin_s, 0.0001, 7.0 + read_s + print_s * (i % 10));
  }
  return stream;
}

TEST(GyroClock, CountsWhereItsTimesAreThoseOfReadingOrPrintingSeveralSamples) {
  for (const double print_s : {0.0, 3e-4}) {
    const GyroStream stream = batches_of(4000, print_s);
    const ClockFit fit = fit_gyro_clock(stream.received, stream.gyro, profile());
    EXPECT_NE(fit.report.own_time_unused, "");
    EXPECT_EQ(fit.report.gaps.size(), 0U);
    ASSERT_EQ(fit.times.size(), 4000U);
    const double first_s = to_s(fit.times[0].time.time_since_epoch());
    for (std::size_t i = 100; i < fit.times.size(); ++i)  // the last of a batch is on its way at once
      ASSERT_NEAR(to_s(fit.times[i].time.time_since_epoch()) - first_s, 0.005 * static_cast<double>(i),
                  0.002);
    EXPECT_LT(fit.report.bound_us, 1e5);
  }
}

/// The same while it comes: lines of text out of the gyro's FIFO, ten at a time, or each when it is taken.
TEST(GyroClock, CountsLiveAsWellAndLosesNothing) {
  for (const int batch : {1, 10}) {
    RigProfile rig;
    rig.gyro.protocol = "text";
    rig.gyro.link.baud = 921600;  // the lines of a batch wait for each other
    rig.gyro.text = {.prefix = "", .rate = {1, 2, 3}, .scale_dps = 1.0, .time = 0, .time_unit_s = 1e-3};
    Pipeline pipeline(rig);
    std::vector<TimedGyro> gyro;
    for (int i = 0; i < 6000; i += batch) {
      const double read_s = 0.005 * (i + batch - 1);
      std::string lines;
      for (int k = 0; k < batch; ++k) lines += fmt::format("{:.0f} 1 2 {}\n", 1e3 * read_s, i + k);
      const std::vector<std::uint8_t> bytes(lines.begin(), lines.end());
      const double sent_s = wire_time_s(bytes.size(), rig.gyro.link.baud);
      pipeline.feed(Device::gyro, bytes, HostTime(from_s(1.0 + read_s + sent_s)));
      const Streams streams = pipeline.take_streams();
      gyro.insert(gyro.end(), streams.gyro.begin(), streams.gyro.end());
    }
    EXPECT_EQ(pipeline.counters(Device::gyro).lost, 0U) << batch;
    ASSERT_GT(gyro.size(), 5900U);
    for (const TimedGyro& sample : std::span(gyro).subspan(3000)) {
      const double taken_s = 1.0 + 0.005 * double{sample.reading.rate_dps[2]};
      ASSERT_NEAR(to_s(sample.stamp.time.time_since_epoch()), taken_s, 0.004) << batch;
    }
  }
}

TEST(GyroClock, GoesOnWhereTheGyrosTimeOf32BitsBeginsAgain) {
  constexpr double wrap_s = 4294.967296;
  GyroStream stream;
  for (int i = 0; i < 4000; ++i) {
    const double own_s = wrap_s - 7.0 + 0.005 * i;
    stream.add(0.005 * i, 0.0001, own_s < wrap_s ? own_s : own_s - wrap_s);
  }
  const ClockFit fit = fit_gyro_clock(stream.received, stream.gyro, profile());
  EXPECT_EQ(fit.report.own_time_unused, "");
  EXPECT_EQ(fit.report.epochs.size(), 1U);
  EXPECT_EQ(fit.report.gaps.size(), 0U);
  EXPECT_LT(worst_error_s(fit), 0.002);
}

TEST(GyroClock, CountsWhereTheOwnTimeIsInAnotherUnitOrMissing) {
  GyroStream stream = stream_of(4000, 1e-3);
  const ClockFit counted = fit_gyro_clock(stream.received, stream.gyro, profile());
  ASSERT_EQ(counted.times.size(), 4000U);
  EXPECT_LT(worst_error_s(counted), 0.002);
  EXPECT_NEAR(counted.report.skew_ppm, 0.0, 50.0);
  stream = stream_of(4000);
  stream.gyro[17].reading.device_time_us.reset();
  EXPECT_NEAR(fit_gyro_clock(stream.received, stream.gyro, profile()).report.skew_ppm, 0.0, 50.0);
}

TEST(GyroClock, CountsWhereTheProtocolsClockSendsNoTime) {
  const GyroStream stream = stream_of(4000);
  GyroProfile without_column = profile();
  without_column.text.time = -1;
  const ClockFit counted = fit_gyro_clock(stream.received, stream.gyro, without_column);
  EXPECT_NEAR(counted.report.skew_ppm, 0.0, 50.0);
}

TEST(GyroClock, SaysNothingWithoutTheBytes) {
  const GyroStream stream = stream_of(100);
  EXPECT_TRUE(fit_gyro_clock({}, stream.gyro, profile()).times.empty());
  EXPECT_TRUE(fit_gyro_clock(stream.received, {}, profile()).times.empty());
  auto beyond = stream.gyro;
  beyond.back().span.end += 1;
  EXPECT_TRUE(fit_gyro_clock(stream.received, beyond, profile()).times.empty());
  auto backwards = stream.gyro;
  std::swap(backwards[3].span, backwards[4].span);
  EXPECT_TRUE(fit_gyro_clock(stream.received, backwards, profile()).times.empty());
}

TEST(GyroClock, BearsAFewMessagesAndAnyOwnTime) {
  for (const int samples : {1, 2, 3}) {
    GyroStream stream = stream_of(samples);
    for (const std::int64_t time_us : {std::numeric_limits<std::int64_t>::min(), std::int64_t{0},
                                       std::numeric_limits<std::int64_t>::max()}) {
      stream.gyro.back().reading.device_time_us = time_us;
      const ClockFit fit = fit_gyro_clock(stream.received, stream.gyro, profile());
      EXPECT_TRUE(fit.times.empty() || fit.times.size() == stream.gyro.size());
    }
  }
}

TEST(CameraClock, NeedsTheCountOfMissingFrames) {
  RawStream received;
  received.append(std::vector<std::uint8_t>(10), HostTime(from_s(1.0)));
  TimedFrame frame;
  frame.span = {0, 10};
  EXPECT_TRUE(fit_camera_clock(received, std::vector{frame}, {}, CameraProfile{}).times.empty());
}

/// Reports of a stepper, ten a second, over one leg at a speed that it states as 90 deg/s.
std::vector<TimedServo> steady_leg(double seconds, double true_dps) {
  std::vector<TimedServo> leg;
  for (double t = 0.0; t < seconds; t += 0.1) {
    TimedServo& report = leg.emplace_back();
    report.state.motion = ServoMotion::steady;
    report.state.rate_dps = 90.0;
    report.state.angle_deg = true_dps * t;
    report.stamp.time = HostTime(from_s(t));
  }
  return leg;
}

TEST(RateScaleBySteps, IsThatOfItsAnglesOverSteadyLegs) {
  const auto scale = rate_scale_by_steps(steady_leg(8.0, 90.45), 0.25);
  ASSERT_TRUE(scale);
  EXPECT_NEAR(*scale, 1.005, 1e-6);
  EXPECT_FALSE(rate_scale_by_steps(steady_leg(0.9, 90.45), 0.25)) << "too short";
}

TEST(RateScaleBySteps, FollowsOneReportThatWasReadLateByLittle) {
  std::vector<TimedServo> leg = steady_leg(8.0, 90.0);
  leg.back().stamp.time += from_s(0.1);
  const auto scale = rate_scale_by_steps(leg, 0.25);
  ASSERT_TRUE(scale);
  EXPECT_NEAR(*scale, 1.0, 0.002);
}

TEST(RateScaleBySteps, IsNoneWhereAnglesAreFurtherOffThanAnyClock) {
  EXPECT_FALSE(rate_scale_by_steps(steady_leg(8.0, 100.0), 0.25));
  EXPECT_FALSE(rate_scale_by_steps(steady_leg(8.0, 1e308), 0.25));
}

}  // namespace
}  // namespace thermorig::fit
