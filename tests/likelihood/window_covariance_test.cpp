// SPDX-License-Identifier: MIT
#include "estimators/likelihood/window_covariance.h"

#include <gtest/gtest.h>

#include <cmath>

#include "estimators/likelihood/speed_table.h"
#include "estimators/likelihood/window_lines.h"

namespace thermorig::likelihood {
namespace {

/// Mean over two boxes of that width, the other way: step by step.
double stepped(double distance, double width, double (*function)(double, double), double parameter) {
  constexpr int steps = 200;
  double sum = 0.0;
  for (int i = 0; i < steps; ++i)
    for (int k = 0; k < steps; ++k) sum += function(distance + width * (i - k) / steps, parameter);
  return sum / (steps * steps);
}

TEST(SweptCovariance, IsThatOfAStillViewMeanOverBothSweeps) {
  for (const double speed : {1.0, -4.0, 12.0})
    for (const double distance : {0.0, 3.0, 20.0})
      EXPECT_NEAR(swept_covariance(distance, speed), stepped(distance, speed, swept_covariance, 0.0), 1e-4)
          << speed << " " << distance;
}

TEST(SweptCovariance, OfAStillViewIsBelowOneAndFallsWithTheDistance) {
  EXPECT_LT(swept_covariance(0.0, 0.0), 1.0);
  EXPECT_GT(swept_covariance(0.0, 0.0), 0.9);
  EXPECT_NEAR(swept_covariance(30.0, 0.0), std::exp(-2.0), 1e-3);
  EXPECT_EQ(swept_covariance(5.0, 3.0), swept_covariance(-5.0, -3.0));
}

TEST(Places, OfTwoHalvesLieOneColumnApartAtRestAndTheSpeedFurtherInMotion) {
  EXPECT_EQ(place_of(1, 2, 0, 0.0) - place_of(0, 2, 0, 0.0), 1.0);
  EXPECT_EQ(place_of(2, 4, 3, 2.5) - place_of(0, 4, 3, 2.5), 5.0);
  EXPECT_EQ(place_of(0, 4, 3, 2.5) - place_of(0, 4, 2, 2.5), 2.0);
}

TEST(WindowCovariance, IsThatOfTheSweepsOfEachTwoPixels) {
  for (const std::size_t halves : {2U, 3U, 4U}) {
    const Eigen::MatrixXd covariance = window_covariance(halves, -3.7);
    ASSERT_EQ(covariance.rows(), halves * line_pixels);
    const auto place = [&](Eigen::Index i) {
      const auto line = static_cast<std::size_t>(i);
      return place_of(line / line_pixels, halves, line % line_pixels, -3.7);
    };
    for (Eigen::Index i = 0; i < covariance.rows(); ++i)
      for (Eigen::Index k = 0; k < covariance.cols(); ++k)
        EXPECT_NEAR(covariance(i, k), swept_covariance(place(i) - place(k), -3.7), 1e-9) << i << " " << k;
  }
}

/// Of a pattern: what each line has of it.
Eigen::VectorXd pattern_of(const SpeedPatterns& patterns, std::size_t k, std::size_t lines) {
  Eigen::VectorXd pattern(static_cast<Eigen::Index>(lines));
  for (std::size_t i = 0; i < lines; ++i)
    pattern(static_cast<Eigen::Index>(i)) = double{
        patterns.pattern[((k / patterns_a_group) * lines + i) * patterns_a_group + k % patterns_a_group]};
  return pattern;
}

/// They are eigenvectors of the covariance, at right angles to each other.
void expect_independent(const SpeedPatterns& patterns, const Eigen::MatrixXd& covariance) {
  const auto lines = static_cast<std::size_t>(covariance.rows());
  ASSERT_GT(patterns.count, 10U);
  for (std::size_t k = 0; k < patterns.count; ++k) {
    const Eigen::VectorXd pattern = pattern_of(patterns, k, lines);
    const Eigen::VectorXd left = covariance * pattern - double{patterns.variance[k]} * pattern;
    EXPECT_LT(left.norm(), 2e-5) << lines << " " << k;
    for (std::size_t other = 0; other <= k; ++other)
      EXPECT_NEAR(pattern.dot(pattern_of(patterns, other, lines)), k == other ? 1.0 : 0.0, 1e-5)
          << lines << " " << k << " " << other;
  }
}

TEST(SpeedTables, HavePatternsThatComeIndependentlyOfEachOther) {
  for (const std::size_t halves : {2U, 3U, 4U}) {
    const SpeedTable& table = SpeedTable::of(halves);
    const std::size_t place = table.own().size() / 2 + 20;
    const double speed = table.own()[place].speed;
    expect_independent(table.own()[place], window_covariance(halves, speed));
    ASSERT_EQ(table.longest()[20].speed, speed);
    Eigen::MatrixXd longest = covariance_of_classes(halves, speed, likeness_of_classes(0));
    centre_halves(longest);
    expect_independent(table.longest()[20], longest);
    double likeness = 0.0;
    for (std::size_t wave = 1; wave < shared_waves; ++wave)
      likeness += likeness_of_classes(wave) / static_cast<double>(shared_waves - 1);
    expect_independent(table.shared()[20], covariance_of_classes(halves, speed, likeness));
  }
}

TEST(SpeedTables, HaveTheirSpeedsAndTheirVariancesFallAndAreAllThatThereIs) {
  const SpeedTable& table = SpeedTable::of(2);
  const std::size_t count = table.own().size();
  for (std::size_t i = 0; i < count; ++i) EXPECT_EQ(table.own()[i].speed, -table.own()[count - 1 - i].speed);
  EXPECT_GT(table.own().back().speed, 17.5);
  for (const auto speeds : {table.own(), table.shared(), table.longest()})
    for (const SpeedPatterns& patterns : speeds) {
      double sum = 0.0;
      for (std::size_t k = 0; k < patterns.variance.size(); ++k) {
        sum += double{patterns.variance[k]};
        if (k > 0) {
          EXPECT_LE(patterns.variance[k], patterns.variance[k - 1]);
        }
      }
      EXPECT_NEAR(sum, patterns.trace, 0.02 * patterns.trace);
    }
  EXPECT_EQ(table.shared().front().speed, 0.0);
  EXPECT_EQ(table.shared().back().speed, table.own().back().speed);
}

TEST(SpeedTables, OfTheLongestWaveHaveNoPatternOfWhatAHalfHasInCommon) {
  const SpeedPatterns& patterns = SpeedTable::of(2).longest().back();
  for (std::size_t k = 0; k < patterns.count; ++k) {
    const Eigen::VectorXd pattern = pattern_of(patterns, k, 4 * line_pixels);
    for (Eigen::Index half = 0; half < 4; ++half)
      EXPECT_NEAR(pattern.segment(half * static_cast<Eigen::Index>(line_pixels), line_pixels).sum(), 0.0,
                  1e-4);
  }
}

TEST(ClassesOfRows, SeeTheSameOfLongWavesAndEachItsOwnOfShortOnes) {
  EXPECT_GT(likeness_of_classes(0), 0.99);
  EXPECT_GT(likeness_of_classes(1), 0.97);
  for (std::size_t wave = 1; wave < half_rows; ++wave)
    EXPECT_LT(likeness_of_classes(wave), likeness_of_classes(wave - 1));
  EXPECT_NEAR(likeness_of_classes(half_rows - 1), 0.0, 0.1);
}

/// In a half the one class sees column 0 where the other sees column 1; in the next one it is the other way.
TEST(ClassesOfRows, LookAtPlacesOfOneScene) {
  constexpr double speed = 2.6;
  const Eigen::MatrixXd covariance = covariance_of_classes(4, speed, 1.0);
  EXPECT_LT((covariance - covariance.transpose()).norm(), 1e-9);
  const auto lines = static_cast<Eigen::Index>(4 * line_pixels);
  const auto last_pixel = static_cast<Eigen::Index>(line_pixels) - 1;  // of a mirrored line: column 1
  for (Eigen::Index half = 0; half < 4; ++half) {
    const Eigen::Index first = half * static_cast<Eigen::Index>(line_pixels);
    EXPECT_NEAR(covariance(first, lines + first + last_pixel), swept_covariance(1.0, speed), 1e-9) << half;
  }
  const auto next_half = static_cast<Eigen::Index>(line_pixels);  // there that pixel is column 0
  EXPECT_NEAR(covariance(0, lines + next_half + last_pixel), swept_covariance(speed, speed), 1e-9);
}

TEST(WindowLines, KeepTheSumOfTheSquaresAndPartItBySize) {
  HalfLines lines{};
  double squares = 0.0;
  for (std::size_t row = 0; row < frame_rows; ++row)
    for (std::size_t k = 0; k < line_pixels; ++k) {
      lines[row][k] = std::sin(0.7F * static_cast<float>(row * 5 + k * 3));
      squares += double{lines[row][k]} * double{lines[row][k]};
    }
  const std::array<const HalfLines*, 2> halves{&lines, &lines};
  WindowLines window(2);
  window.set(0, halves);
  double longest = 0.0, others = 0.0;
  for (std::size_t row_class = 0; row_class < 2; ++row_class)
    for (std::size_t i = 0; i < window.lines(); ++i) {
      const double wave = double{window.waves(row_class)[i * half_rows]};
      longest += wave * wave;
    }
  for (std::size_t wave = 1; wave < half_rows; ++wave) others += window.energy(wave);
  EXPECT_NEAR(longest + others, 2.0 * squares, 1e-3);
  EXPECT_LE(window.energy(0), longest + 1e-6);
}

TEST(WindowLines, SeeWhatAllPixelsHaveInCommonInTheLongestWaveAloneAndTakeItOff) {
  HalfLines one{}, other{};
  for (std::size_t row = 0; row < frame_rows; ++row)
    for (std::size_t k = 0; k < line_pixels; ++k) {
      one[row][k] = 20.0F;
      other[row][k] = 21.0F;
    }
  const std::array<const HalfLines*, 2> halves{&one, &other};
  WindowLines window(2);
  window.set(1, halves);
  for (std::size_t wave = 0; wave < half_rows; ++wave) EXPECT_NEAR(window.energy(wave), 0.0, 1e-6) << wave;
}

}  // namespace
}  // namespace thermorig::likelihood
