// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/labels/measured_track.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

namespace thermorig::labels {
namespace {

constexpr double reading_s = 0.005;
constexpr float noise_deg = 0.05F;

HostTime instant(double seconds) {
  return HostTime(from_s(seconds));
}

/// 200 readings a second of a shaft that goes as `angle_deg` says, over `length_s`.
struct MeasuredShaft {
  std::function<double(double)> angle_deg;
  std::function<void(TimedShaft&, double)> spoil = [](TimedShaft&, double) {};

  double period_s = reading_s;
  double bridged_s = 0.0;

  MeasuredTrack track(unsigned seed, double length_s = 2.0) const {
    std::mt19937 random(seed);
    std::normal_distribution<double> noise(0.0, noise_deg);
    MeasuredTrack track(from_s(10.0), from_s(bridged_s));
    for (int i = 0; i * period_s <= length_s; ++i) {
      TimedShaft shaft;
      shaft.stamp.time = instant(i * period_s);
      shaft.reading.uncertainty_deg = noise_deg;
      shaft.angle_deg = angle_deg(i * period_s) + noise(random);
      spoil(shaft, i * period_s);
      track.add(shaft);
    }
    return track;
  }
};

/// How far mean speeds over 0.25 s are off on average, over what is stated of them.
double error_over_stated(const MeasuredShaft& shaft, const std::function<double(double)>& true_deg,
                         int trials = 200) {
  double sum = 0.0;
  for (int trial = 0; trial < trials; ++trial) {
    const MeasuredTrack track = shaft.track(static_cast<unsigned>(trial), 0.6);
    const auto rate = track.rate_dps(instant(0.151), instant(0.401)).value();
    const double error_dps = rate.value - (true_deg(0.401) - true_deg(0.151)) / 0.25;
    sum += error_dps * error_dps / (rate.uncertainty * rate.uncertainty);
  }
  return std::sqrt(sum / trials);
}

TEST(MeasuredTrack, OfAnEvenMotionItStatesWhatItsNoiseLeaves) {
  const auto even = [](double t) { return 20.0 * t; };
  const MeasuredTrack track = MeasuredShaft{even}.track(1);
  const auto rate = track.rate_dps(instant(0.5), instant(0.75)).value();
  EXPECT_NEAR(rate.value, 20.0, 0.25);
  EXPECT_NEAR(rate.uncertainty, std::sqrt(2.0) * 0.05 / std::sqrt(20.0) / 0.25, 0.02);
  EXPECT_NEAR(error_over_stated({even}, even), 1.0, 0.25);
}

TEST(MeasuredTrack, OfAShaftThatSticksAndSlipsItStatesMore) {
  const auto jerky = [](double t) { return 20.0 * t - 0.5 * std::sin(40.0 * t); };  // it all but stops
  const MeasuredTrack track = MeasuredShaft{jerky}.track(1);
  EXPECT_NEAR(track.rate_dps(instant(0.5), instant(0.7)).value().value, 20.0, 3.0);
  const double ratio = error_over_stated({jerky}, jerky);
  EXPECT_LT(ratio, 1.3);
  EXPECT_GT(ratio, 0.3);
}

TEST(MeasuredTrack, OfAShaftThatStandsAndGoesItStatesHowFarItIsOff) {
  constexpr int phases = 8;
  for (const double period_s : {0.04, 0.1, 0.2})
    for (const double going : {0.5, 0.1}) {  // of the time
      double sum = 0.0;
      for (int phase = 0; phase < phases; ++phase) {
        const auto stands_and_goes = [=](double t) {
          const double periods = t / period_s + phase / double{phases}, begun = std::floor(periods);
          return 20.0 * period_s * (begun + std::max(0.0, (periods - begun - (1.0 - going)) / going));
        };
        sum += std::pow(error_over_stated({stands_and_goes}, stands_and_goes, 25), 2);
      }
      EXPECT_LT(std::sqrt(sum / phases), 1.5) << period_s << ", " << going;
      EXPECT_GT(std::sqrt(sum / phases), 0.5) << period_s << ", " << going;
    }
}

/// As servos are read that answer when they are asked; the host is busy for nearly 0.1 s.
MeasuredShaft asked(const std::function<double(double)>& angle_deg) {
  return {.angle_deg = angle_deg,
          .spoil =
              [](TimedShaft& reading, double t) {
                if (t > 0.362 && t < 0.443) reading.angle_deg = std::nan("");
              },
          .period_s = 0.024,
          .bridged_s = 0.12};
}

TEST(MeasuredTrack, AcrossTheSilenceOfABusyHostItStatesWhatItDoesNotKnow) {
  constexpr int phases = 8;
  for (const double wave_deg : {0.0, 0.3}) {
    double sum = 0.0;
    for (int phase = 0; phase < phases; ++phase) {
      const auto moves = [=](double t) {
        return 100.0 * t + wave_deg * std::sin(30.0 * t + 2.0 * std::numbers::pi * phase / phases);
      };
      sum += std::pow(error_over_stated(asked(moves), moves, 25), 2);
    }
    EXPECT_LT(std::sqrt(sum / phases), 1.5) << wave_deg;
    EXPECT_GT(std::sqrt(sum / phases), 0.4) << wave_deg;
  }
}

TEST(MeasuredTrack, AcrossASilenceInWhichTheShaftStopsOrStartsItStatesHowFarItIsOff) {
  for (const double going : {0.0, 1.0})  // behind it
    for (const int behind : {1, 10}) {
      double sum = 0.0, count = 0.0;
      for (unsigned seed = 0; seed < 200; ++seed) {
        const double turns_s = 0.36 + 0.0004 * seed;
        const auto angle = [=](double t) {
          return 100.0 * (going * std::max(0.0, t - turns_s) + (1.0 - going) * std::min(0.0, t - turns_s));
        };
        const MeasuredTrack track = asked(angle).track(seed, 0.443 + 0.024 * behind);
        for (const double t : {0.38, 0.4, 0.42}) {
          const auto found = track.angle_deg(instant(t));
          ASSERT_TRUE(found);
          const double error = (found->value - angle(t)) / found->uncertainty;
          EXPECT_LT(std::abs(error), 5.0) << going << ", " << turns_s << ", " << behind << ", " << t;
          sum += error * error;
          count += 1.0;
        }
      }
      EXPECT_LT(std::sqrt(sum / count), 1.5) << going << ", " << behind;
      EXPECT_GT(std::sqrt(sum / count), 0.6) << going << ", " << behind;
    }
}

TEST(MeasuredTrack, ReadingsOfOneInstantOrOfNoKnownWorthLeaveFiniteAngles) {
  const MeasuredShaft shaft = asked([](double t) { return 100.0 * t; });
  MeasuredTrack track = shaft.track(1, 0.36);
  for (const double t : {0.36, 0.45, 0.45, 0.47}) {
    TimedShaft reading;
    reading.stamp.time = instant(t);
    reading.angle_deg = 100.0 * t;
    reading.reading.uncertainty_deg = t > 0.46 ? std::nanf("") : noise_deg;
    track.add(reading);
  }
  for (const double t : {0.34, 0.38, 0.44}) {
    const auto found = track.angle_deg(instant(t));
    if (!found) continue;
    EXPECT_TRUE(std::isfinite(found->value) && std::isfinite(found->uncertainty)) << t;
    EXPECT_NEAR(found->value, 100.0 * t, 1.0) << t;
  }
  EXPECT_TRUE(track.angle_deg(instant(0.34)));
}

TEST(MeasuredTrack, ASensorThatIsNotAskedLeavesNothingInASilence) {
  MeasuredShaft shaft{[](double t) { return 100.0 * std::min(t, 0.43); }};
  shaft.spoil = [](TimedShaft& reading, double t) {
    if (t > 0.36 && t < 0.44) reading.angle_deg = std::nan("");
  };
  const MeasuredTrack track = shaft.track(1);
  EXPECT_FALSE(track.angle_deg(instant(0.4)));
  EXPECT_FALSE(track.rate_dps(instant(0.2), instant(0.4)));
}

TEST(MeasuredTrack, ASilenceOrTurnsThatWereCountedAnewLeaveNoSpeed) {
  const auto even = [](double t) { return 100.0 * t; };
  MeasuredShaft shaft{even};
  shaft.spoil = [](TimedShaft& reading, double t) {
    if (t > 0.5 && t < 0.65) reading.angle_deg = std::nan("");
    reading.lost_before = std::abs(t - 1.0) < 1e-9;
  };
  const MeasuredTrack track = shaft.track(1);
  EXPECT_FALSE(track.angle_deg(instant(0.575)));
  EXPECT_FALSE(track.rate_dps(instant(0.3), instant(0.575)));
  EXPECT_TRUE(track.rate_dps(instant(0.45), instant(0.7)));  // no turn was missed meanwhile
  EXPECT_FALSE(track.rate_dps(instant(0.9), instant(1.1)));
  EXPECT_FALSE(track.angle_deg(instant(0.9975)));
  EXPECT_TRUE(track.rate_dps(instant(1.1), instant(1.2)));
  EXPECT_FALSE(track.rate_dps(instant(1.9), instant(2.5)));  // nothing was read by then
}

}  // namespace
}  // namespace thermorig::labels
