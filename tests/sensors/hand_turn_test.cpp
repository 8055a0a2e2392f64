// SPDX-License-Identifier: MIT
// A turn by hand about the vertical axis tells the column and the unit that no word says. All values are made
// up.
#include "thermorig/sensors/hand_turn.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "support/chunking.h"

namespace thermorig::test::hand_turn {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr double heard_s = 6.0;
constexpr int lines = 600;

/// deg/s at a time: still, a smooth turn of 90 deg within two seconds, still.
double turn_dps(double time_s, double angle_deg) {
  if (time_s < 2.0 || time_s > 4.0) return 0.0;
  return 0.5 * angle_deg * (1.0 - std::cos(std::numbers::pi * (time_s - 2.0)));
}

double angle_deg(double time_s, double whole_deg) {
  if (time_s < 2.0) return 0.0;
  if (time_s > 4.0) return whole_deg;
  const double since_s = time_s - 2.0;
  return 0.5 * whole_deg * (since_s - std::sin(std::numbers::pi * since_s) / std::numbers::pi);
}

using Line = std::function<std::string(double rate, double angle, double noise)>;

std::optional<sensors::HandTurn> turned(const Line& line, double scale_dps, double whole_deg = 90.0) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise;
  std::string text = "tail\n";
  for (int i = 0; i < lines; ++i) {
    const double time_s = heard_s * i / lines;
    text += line((turn_dps(time_s, whole_deg) + 0.1 * noise(random)) / scale_dps,
                 angle_deg(time_s, whole_deg), noise(random)) +
            "\n";
  }
  const ByteVector bytes(text.begin(), text.end());
  const auto format = sensors::guess_text_format(bytes, sensors::StreamStart::anywhere, heard_s);
  return format ? sensors::turned_by_hand(bytes, *format, heard_s) : std::nullopt;
}

/// Nine bare columns: accelerations, rates, a magnetic field that turns with the angle.
std::string nine(double rate, double angle, double noise) {
  const double angle_rad = angle * std::numbers::pi / 180.0;
  return fmt::format("{:.3f},{:.3f},{:.3f},{:.4f},{:.4f},{:.4f},{:.2f},{:.2f},{:.2f}", 0.004 * noise,
                     -0.02 - 0.004 * noise, 1.0 + 0.004 * noise, 0.001 * noise, -0.001 * noise, rate,
                     20.0 * std::cos(angle_rad) + 0.2 * noise, 20.0 * std::sin(angle_rad) + 0.2 * noise,
                     39.0 + 0.2 * noise);
}

TEST(HandTurn, TellsColumnAndUnitOfNineBareColumns) {
  const auto found = turned(nine, 57.29577951308232);
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->column, 5);
  EXPECT_EQ(found->axis, 2);
  EXPECT_NEAR(found->format.columns.scale_dps, 57.29578, 1e-4);
  EXPECT_TRUE(found->format.is_known());
  EXPECT_THAT(found->format.assumptions, ElementsAre(HasSubstr("rad/s")));
}

TEST(HandTurn, TellsTheRangeOfCounts) {
  const auto counts = [](double rate, double, double noise) {
    return fmt::format("gx:{:.0f} gy:{:.0f} gz:{:.0f}", 3.0 * noise, rate, -3.0 * noise);
  };
  for (const double counts_per_dps : {131.0, 65.5, 32.8, 16.4}) {
    const auto found = turned(counts, 1.0 / counts_per_dps);
    ASSERT_TRUE(found.has_value()) << counts_per_dps;
    EXPECT_EQ(found->axis, 1);
    EXPECT_NEAR(found->format.columns.scale_dps * counts_per_dps, 1.0, 1e-9);
  }
}

TEST(HandTurn, AllowsAHandThatTurnsALittleTooFar) {
  EXPECT_TRUE(turned(nine, 1.0, 110.0).has_value());
}

TEST(HandTurn, TellsNothingOfAQuarterOfATurn) {
  EXPECT_FALSE(turned(nine, 1.0, 22.0).has_value());
}

TEST(HandTurn, TellsNothingWhereNoColumnIsARate) {
  const auto angles = [](double, double angle, double noise) {
    return fmt::format("{:.2f},{:.2f},{:.2f}", angle + 0.05 * noise, 2.0 + 0.05 * noise, -1.0 - 0.05 * noise);
  };
  EXPECT_FALSE(turned(angles, 1.0).has_value());
}

}  // namespace
}  // namespace thermorig::test::hand_turn
