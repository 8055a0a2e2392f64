// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "fit/clocks/sliding_fit.h"
#include "thermorig/fit/clocks/recorded_clock.h"
#include "thermorig/pipeline/timing/lower_line.h"
#include "timing/recorded_stream.h"

namespace thermorig::fit {

using namespace timing;

namespace {

using simulation::UsbLink;

const TestLink busy_ftdi{"ftdi16", UsbLink::ftdi, 0.016, true};
const TestLink ftdi_1_ms{"ftdi1", UsbLink::ftdi, 0.001, false};

TEST(Numbering, CountsNoLateReadAsALoss) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const RecordedStream gyro = record_stream(Device::gyro, busy_ftdi, seed, 60.0);
    EXPECT_EQ(fit_stream(gyro).number, gyro.index);
  }
}

TEST(Numbering, FindsFramesThatNobodySawGoMissing) {
  const RecordedStream whole = record_stream(Device::camera, busy_ftdi, 4, 120.0);
  const auto lost = [](std::size_t i) { return i == 100 || i == 300 || i == 301 || i == 302 || i == 700; };
  const RecordedStream camera = whole.without(lost, false);
  const FittedStream fitted = fit_stream(camera);
  EXPECT_EQ(fitted.number, camera.index);
  ASSERT_EQ(fitted.clock.report.gaps.size(), 3U);
  EXPECT_EQ(fitted.clock.report.gaps[1].missing, 3U);
}

TEST(Numbering, FindsSamplesThatWereDamaged) {
  for (const TestLink& link : {busy_ftdi, ftdi_1_ms}) {
    const RecordedStream whole = record_stream(Device::gyro, link, 5, 60.0);
    std::mt19937 random(1);
    const auto lost = [&](std::size_t i) { return i > 0 && i < 11000 && random() % 2000 == 0; };
    const RecordedStream gyro = whole.without(lost, true);
    ASSERT_LT(gyro.spans.size(), whole.spans.size());
    EXPECT_EQ(fit_stream(gyro).number, gyro.index) << link.name;
  }
}

TEST(Numbering, CountsSamplesThatNobodySawGoMissing) {
  const RecordedStream whole = record_stream(Device::gyro, ftdi_1_ms, 6, 60.0);
  const RecordedStream gyro = whole.without([](std::size_t i) { return i % 3000 == 1500; }, false);
  const auto number = fit_stream(gyro).number;
  EXPECT_EQ(number.back(), gyro.index.back());
  int wrong = 0;
  for (std::size_t i = 0; i < number.size(); ++i) wrong += number[i] != gyro.index[i];
  EXPECT_LT(wrong, 100);  // where exactly is a guess
}

/// Proofs of a device of `rate_hz`, a little late each.
std::vector<HostTime> proofs(double rate_hz, int count, const auto& is_lost) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> late_s(0.0, 0.004);
  std::vector<HostTime> latest;
  for (int i = 0; i < count; ++i)
    if (!is_lost(i)) latest.push_back(HostTime(from_s(i / rate_hz + late_s(random))));
  return latest;
}

TEST(Numbering, NeedsTheNominalRateOnlyAsAHint) {
  const auto lost = [](int i) { return i == 90; };
  for (const double nominal_hz : {8.0, 4.0, 3.93, 0.0, std::nan("")}) {
    const auto number = number_messages(proofs(3.92, 200, lost), {}, nominal_hz);
    EXPECT_EQ(number[89], 89) << nominal_hz;
    EXPECT_EQ(number[90], 91) << nominal_hz;
    EXPECT_EQ(number.back(), 199) << nominal_hz;
  }
}

TEST(Numbering, ClaimsNoLossOnADeviceWithoutASteadyRate) {
  std::mt19937 random(9);
  std::exponential_distribution<double> pause_s(50.0);
  std::vector<HostTime> latest{HostTime(from_s(1.0))};
  for (int i = 0; i < 3000; ++i) latest.push_back(latest.back() + from_s(pause_s(random)));
  const auto number = number_messages(latest, {}, 50.0);
  EXPECT_EQ(number.back(), 3000);
}

/// A board that waits between its samples: each delay of its loop stays.
TEST(Numbering, ClaimsNoLossOnADeviceWhoseLoopDawdles) {
  for (const double jitter : {0.02, 0.2, 1.0})
    for (unsigned seed = 1; seed <= 20; ++seed) {
      std::mt19937 random(seed);
      std::normal_distribution<double> stray(1.0, jitter);
      std::uniform_real_distribution<double> late_s(0.0, 0.001);
      std::vector<HostTime> latest;
      double time_s = 0.0;
      for (int i = 0; i < 6000; ++i) {
        time_s += 0.01 * std::max(stray(random), 0.2);
        latest.push_back(HostTime(from_s(std::ceil(time_s / 0.016) * 0.016 + late_s(random))));
      }
      EXPECT_EQ(number_messages(latest, {}, 100.0).back(), 5999) << jitter << ", seed " << seed;
    }
}

TEST(Numbering, AscendsWhateverComes) {
  const auto none = [](int) { return false; };
  std::vector<std::vector<HostTime>> streams{{},
                                             proofs(100.0, 1, none),
                                             proofs(100.0, 2, none),
                                             std::vector<HostTime>(50, HostTime(from_s(3.0))),
                                             std::vector<HostTime>(50, HostTime::max())};
  streams.push_back(proofs(100.0, 500, none));
  std::reverse(streams.back().begin(), streams.back().end());
  streams.push_back(
      {HostTime::min(), HostTime::max(), HostTime{}, HostTime::min(), HostTime::max(), HostTime{}});
  for (const auto& latest : streams) {
    const auto number = number_messages(latest, {}, 100.0);
    ASSERT_EQ(number.size(), latest.size());
    for (std::size_t i = 0; i < number.size(); ++i)
      EXPECT_TRUE(i == 0 ? number[i] == 0 : number[i] > number[i - 1]);
  }
}

constexpr double otherwise = 7.0;

TEST(LowerLine, OfFewerThanTwoCeilingsIsWhatIsGivenForThatCase) {
  EXPECT_EQ(lower_line_slope({}, otherwise), otherwise);
  EXPECT_EQ(lower_line_slope(std::vector<Ceiling>{{1.0, 2.0}}, otherwise), otherwise);
}

TEST(LowerLine, OfTwoCeilingsGoesThroughBoth) {
  EXPECT_DOUBLE_EQ(lower_line_slope(std::vector<Ceiling>{{1.0, 2.0}, {3.0, 3.0}}, otherwise), 0.5);
}

TEST(LowerLine, LiesUnderAllCeilingsAndTouchesThoseOnEitherSideOfTheirMiddle) {
  const std::vector<Ceiling> ceilings{{0.0, 0.0}, {1.0, 5.0}, {2.0, 1.0}, {3.0, 9.0}, {4.0, 4.0}};
  EXPECT_DOUBLE_EQ(lower_line_slope(ceilings, otherwise), 0.5);  // from the first to the third
}

/// A clock whose rate swings by so much that neighbouring windows have other parabolas.
SlidingFit fit_of_a_swinging_clock() {
  std::vector<Ceiling> ceilings;
  for (int i = 0; i < 600; ++i) {
    const double x = 0.1 * i;
    ceilings.push_back({x, 0.004 * std::sin(x / 6.0) + 0.001 * std::abs(std::sin(97.0 * x))});
  }
  return SlidingFit(ceilings, {.length_s = 12.0, .block_s = 2.0}, 1e-3);
}

TEST(SlidingFit, IsHalfOfEachParabolaHalfwayBetweenTheirKnots) {
  SlidingFit fit = fit_of_a_swinging_clock();
  const auto& knots = fit.knots();
  double most_apart_s = 0.0;
  for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
    const double x = 0.5 * (knots[i].x + knots[i + 1].x);
    const double left = knots[i].curve.at(x);
    const double right = knots[i + 1].curve.at(x);
    EXPECT_NEAR(fit.at(x), 0.5 * (left + right), 1e-12) << x;
    most_apart_s = std::max(most_apart_s, std::abs(left - right));
  }
  EXPECT_GT(most_apart_s, 1e-5);
}

TEST(SlidingFit, HasNoKinkAtAKnot) {
  SlidingFit fit = fit_of_a_swinging_clock();
  const double step = 1e-4;
  for (const SlidingFit::Knot& knot : fit.knots()) {
    if (&knot == &fit.knots().front() || &knot == &fit.knots().back()) continue;
    const double left = (fit.at(knot.x) - fit.at(knot.x - step)) / step;
    const double right = (fit.at(knot.x + step) - fit.at(knot.x)) / step;
    EXPECT_NEAR(left, knot.curve.slope(knot.x), 1e-7) << knot.x;
    EXPECT_NEAR(right, knot.curve.slope(knot.x), 1e-7) << knot.x;
  }
}

}  // namespace

}  // namespace thermorig::fit
