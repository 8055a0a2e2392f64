// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cmath>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "thermorig/core/auto_zero.h"
#include "thermorig/core/code_point.h"
#include "thermorig/core/error.h"
#include "thermorig/core/estimate.h"
#include "thermorig/core/label.h"
#include "thermorig/core/nearest_name.h"
#include "thermorig/core/run_all.h"
#include "thermorig/core/statistics.h"

namespace thermorig {

namespace {

TEST(Median, IsTheMiddleOrTheUpperOfTheTwoInTheMiddle) {
  EXPECT_EQ(median({3.0, 1.0, 2.0}), 2.0);
  EXPECT_EQ(median({4.0, 1.0, 3.0, 2.0}), 3.0);
  EXPECT_EQ(median({}), 0.0);
  std::array values{9.0F, 7.0F, 8.0F, 1.0F};
  EXPECT_EQ(reordering_median(std::span(values).first(3)), 8.0F);
  EXPECT_EQ(values[3], 1.0F);  // not one of them
}

TEST(RobustDeviation, IsThatOfANormalDistributionWhateverAFewOutliersAre) {
  EXPECT_DOUBLE_EQ(robust_deviation({9.0, 10.0, 11.0, 10.0, 1e9}, 10.0), 1.4826);
  EXPECT_EQ(robust_deviation({}, 0.0), 0.0);
}

TEST(Quantiles, AreOneOfTheValuesRoundedDownOrUp) {
  std::vector<double> values{50.0, 10.0, 40.0, 20.0, 30.0};
  EXPECT_EQ(lower_quantile(values, 0.0), 10.0);
  EXPECT_EQ(lower_quantile(values, 0.6), 30.0);
  EXPECT_EQ(upper_quantile(values, 0.6), 40.0);
  EXPECT_EQ(lower_quantile(values, 1.0), 50.0);
  EXPECT_EQ(upper_quantile(values, 0.5), 30.0);
  EXPECT_EQ(lower_quantile(std::vector<double>{}, 0.5), 0.0);
  EXPECT_EQ(upper_quantile(std::vector<double>{}, 0.5), 0.0);
}

TEST(Quantile, OfSortedValuesLiesBetweenThem) {
  const std::vector<double> sorted{10.0, 20.0, 40.0};
  EXPECT_DOUBLE_EQ(quantile(sorted, 0.25), 15.0);
  EXPECT_DOUBLE_EQ(quantile(sorted, 0.75), 30.0);
  EXPECT_EQ(quantile(sorted, 1.0), 40.0);
  EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
}

TEST(RunningStatistics, AreThoseOfAllNumbersThatCame) {
  RunningStatistics statistics;
  EXPECT_EQ(statistics.variance(), 0.0);
  for (const double value : {1e9 + 1.0, 1e9 + 2.0, 1e9 + 3.0, 1e9 + 6.0}) {
    statistics.add(value);
    if (statistics.count() == 1) {
      EXPECT_EQ(statistics.sample_variance(), 0.0);
    }
  }
  EXPECT_EQ(statistics.count(), 4U);
  EXPECT_DOUBLE_EQ(statistics.mean(), 1e9 + 3.0);
  EXPECT_DOUBLE_EQ(statistics.variance(), 3.5);  // not lost beside the mean's square
  EXPECT_DOUBLE_EQ(statistics.sample_variance(), 14.0 / 3.0);
}

TEST(RecentCount, TellsWhatHappensOftenFromWhatHappensNowAndThen) {
  RecentCount rare, frequent;
  for (int i = 0; i < 1000; ++i) {
    rare.add(i % 100 == 0);
    frequent.add(i % 20 == 0);
  }
  EXPECT_FALSE(rare.is_frequent());
  EXPECT_TRUE(frequent.is_frequent());
  for (int i = 0; i < 200; ++i) frequent.add(false);
  EXPECT_FALSE(frequent.is_frequent());
}

TEST(LabelName, IsReadBack) {
  for (const Label label : {Label::commanded, Label::corrected, Label::shaft})
    EXPECT_EQ(label_named(name_of(label)), label);
  EXPECT_EQ(column_of(Label::corrected), "rate_corrected");
}

TEST(LabelName, ThatThereIsNotIsRefusedWithTheNearest) {
  EXPECT_FALSE(find_label("rate_shaft"));
  try {
    label_named("comanded");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_usage);
    EXPECT_EQ(error.what_happened(), "there is no label \"comanded\"");
    EXPECT_EQ(error.advice(), "did you mean \"commanded\"? one of: commanded, corrected, measured, shaft");
  }
}

const std::vector<std::string> names{"witmotion", "text", "mavlink"};

TEST(NearestName, IsTheOneWithFewEdits) {
  EXPECT_EQ(advice_on_name("witmoton", names),
            "did you mean \"witmotion\"? one of: witmotion, text, mavlink");
  EXPECT_EQ(advice_on_name("maflink", names), "did you mean \"mavlink\"? one of: mavlink, text, witmotion");
  EXPECT_EQ(advice_on_name("etxt", names), "did you mean \"text\"? one of: text, witmotion, mavlink");
  EXPECT_EQ(advice_on_name("tekst", names), "did you mean \"text\"? one of: text, mavlink, witmotion");
}

TEST(NearestName, IsNotGuessedWhereNoneIsNear) {
  EXPECT_EQ(advice_on_name("nmea0183", names).find("did you mean"), std::string::npos);
  EXPECT_EQ(advice_on_name("", names).find("did you mean"), std::string::npos);
}

TEST(NearestName, IsLookedForInTheBeginningOfALongWord) {
  EXPECT_EQ(advice_on_name(std::string(1'000'000, 'x'), names).find("did you mean"), std::string::npos);
}

}  // namespace

TEST(CodePoint, ControlsAreC0DeleteAndC1) {
  for (char32_t code_point = 0; code_point < 0x100; ++code_point)
    EXPECT_EQ(is_control(code_point), code_point < 0x20 || (code_point > 0x7e && code_point < 0xa0))
        << static_cast<unsigned>(code_point);
}

TEST(CodePoint, KnowsEachThatChangesTheDirection) {
  int changing = 0;
  for (char32_t code_point = 0; code_point <= 0x10ffff; ++code_point)
    if (changes_direction(code_point)) {
      ++changing;
      EXPECT_TRUE(is_invisible(code_point)) << static_cast<unsigned>(code_point);
    }
  EXPECT_EQ(changing, 12);  // as many as Unicode's Bidi_Control has
}

TEST(CodePoint, WhatDrawsNothingIsInvisible) {
  for (const char32_t code_point :
       {0xad, 0x34f, 0x61c, 0x1160, 0x180e, 0x200b, 0x200d, 0x2060, 0x2064, 0x206f, 0x3164, 0xfe00, 0xfeff,
        0xffa0, 0xfff9, 0x1d173, 0xe0001, 0xe0041, 0xe01ef})
    EXPECT_TRUE(is_invisible(code_point)) << static_cast<unsigned>(code_point);
}

TEST(CodePoint, BlanksLettersAndEmojisAreVisible) {
  for (const char32_t code_point : {0x20, 0x41, 0xa0, 0xb0, 0xe9, 0x301, 0x5d0, 0x627, 0x1100, 0x200a, 0x2010,
                                    0x202f, 0x3000, 0x4e00, 0xfe0f, 0xfffd, 0x1f327})
    EXPECT_TRUE(is_plain(code_point)) << static_cast<unsigned>(code_point);
}

TEST(CodePoint, PlainTextHasNoLineSeparators) {
  for (const char32_t code_point : {0x0a, 0x0d, 0x85, 0x2028, 0x2029})
    EXPECT_FALSE(is_plain(code_point)) << static_cast<unsigned>(code_point);
}

namespace {

constexpr std::size_t many = 1000;

TEST(AllCores, DoEachNumberOnce) {
  std::vector<std::atomic<int>> done(many);
  on_all_cores(many, [&](std::size_t i) { ++done[i]; });
  for (const auto& times : done) EXPECT_EQ(times, 1);
}

TEST(AllCores, HaveNothingToDoForNone) {
  on_all_cores(0, [](std::size_t) { FAIL(); });
}

TEST(AllCores, ThrowWhatTheLowestNumberThrewThatFailed) {
  for (int round = 0; round < 20; ++round) {
    try {
      on_all_cores(many, [](std::size_t i) {
        if (i % 100 == 37) throw std::runtime_error(std::to_string(i));
      });
      ADD_FAILURE();
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "37");
    }
  }
}

TEST(AllCores, BeginNothingAfterAFailureWasSeen) {
  std::atomic<std::size_t> begun = 0;
  EXPECT_THROW(on_all_cores(1'000'000,
                            [&](std::size_t) {
                              ++begun;
                              throw std::runtime_error("at once");
                            }),
               std::runtime_error);
  EXPECT_LT(begun, 1000U);
}

TEST(WeightedMean, CountsTheScatterWhereItIsMoreThanTheUncertaintiesSay) {
  const Estimate agreeing = weighted_mean(std::array<Estimate, 2>{{{1.0, 0.1}, {1.1, 0.2}}});
  EXPECT_NEAR(agreeing.value, 1.02, 1e-12);
  EXPECT_NEAR(agreeing.uncertainty, 1.0 / std::sqrt(125.0), 1e-12);
  const Estimate apart = weighted_mean(std::array<Estimate, 2>{{{0.0, 0.1}, {1.0, 0.1}}});
  EXPECT_NEAR(apart.uncertainty, 0.5, 1e-12);
}

TEST(LineFit, FindsTheLineOfPointsFarFromZero) {
  LineFit line;
  for (int i = 0; i < 100; ++i) line.add(1e9 + 0.01 * i, 1e6 + 0.25 * i + (i % 2 == 0 ? 0.1 : -0.1), 2.0);
  EXPECT_NEAR(line.slope(), 25.0, 0.01);
  EXPECT_NEAR(line.at(1e9 + 0.5), 1e6 + 12.5, 0.01);
  EXPECT_NEAR(line.residual_squares(), 2.0, 0.01);
  EXPECT_NEAR(line.correlation(), 1.0, 1e-3);
}

TEST(LineFit, TellsNoSlopeOfPointsAboveOneAnother) {
  LineFit line;
  EXPECT_EQ(line.slope(), 0.0);
  for (const double y : {1.0, 2.0, 6.0}) line.add(0.1, y);
  EXPECT_EQ(line.slope(), 0.0);
  EXPECT_EQ(line.correlation(), 0.0);
  EXPECT_DOUBLE_EQ(line.at(5.0), 3.0);
}

constexpr float count_dps = 2000.0F / 32768.0F;  // WitMotion's

/// Samples of a gyro at rest, in whole steps.
void add_rest(AutoZero& zeros, int samples, float bias_dps, float noise_dps, float step_dps, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> noise(bias_dps, noise_dps);
  const auto read = [&] { return step_dps * std::round(noise(random) / step_dps); };
  for (int i = 0; i < samples; ++i) zeros.add({{read(), read(), read()}});
}

void add_zeros(AutoZero& zeros, std::size_t samples) {
  for (std::size_t i = 0; i < samples; ++i) zeros.add({{0.0F, -0.0F, 0.0F}});
}

TEST(AutoZero, IsSeenWhereAGyroGoesToZeroAndStaysThere) {
  AutoZero zeros;
  add_rest(zeros, 500, -1.47F, 0.07F, count_dps, 1);
  EXPECT_FALSE(zeros.is_seen());
  add_zeros(zeros, 1000);
  EXPECT_TRUE(zeros.is_seen());
  EXPECT_EQ(zeros.longest(), 1000U);
}

TEST(AutoZero, IsSeenWhereThereIsNothingButZeros) {
  AutoZero zeros;
  add_zeros(zeros, AutoZero::fewest_zeros - 1);
  EXPECT_FALSE(zeros.is_seen());
  add_zeros(zeros, 1);
  EXPECT_TRUE(zeros.is_seen());
}

TEST(AutoZero, IsNotTheNoiseOfAGyroWithoutABias) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    AutoZero zeros;
    add_rest(zeros, 5000, 0.0F, 0.05F, count_dps, seed);
    EXPECT_FALSE(zeros.is_seen()) << seed << ": " << zeros.longest();
  }
}

TEST(AutoZero, IsNotToldOfReadingsTooCoarseForAnyNoise) {
  AutoZero zeros;
  add_rest(zeros, 5000, 0.0F, 0.3F, 1.0F, 2);
  add_zeros(zeros, 1000);
  EXPECT_FALSE(zeros.is_seen());
}

TEST(AutoZero, ReachesOverNoPause) {
  AutoZero zeros;
  for (int i = 0; i < 10; ++i) {
    add_zeros(zeros, AutoZero::fewest_zeros / 2);
    zeros.pause();
  }
  EXPECT_FALSE(zeros.is_seen());
}

}  // namespace

}  // namespace thermorig
