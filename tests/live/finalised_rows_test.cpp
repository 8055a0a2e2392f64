// SPDX-License-Identifier: MIT
#include "thermorig/estimators/live/finalised_rows.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "../support/paper_estimates.h"
#include "../support/same_row.h"

namespace thermorig::live {
namespace {

constexpr double period_s = 0.125;

HostTime time_of(std::uint32_t frame) {
  return HostTime{} + from_s(100.0 + period_s * frame);
}

/// Ten frames: the third is not valid.
network::Acquisition finished() {
  network::Acquisition acquisition;
  for (std::size_t i = 0; i < 10; ++i) {
    acquisition.label_dps.push_back(100.0F + static_cast<float>(i));
    acquisition.gyro_dps.push_back(200.0F + static_cast<float>(i));
    acquisition.time.push_back(time_of(static_cast<std::uint32_t>(i)));
    acquisition.run.push_back(i == 2 ? 0 : i < 2 ? 1 : 2);
  }
  return acquisition;
}

EstimateRow journal_row(std::uint32_t frame, float label_dps = 100.0F) {
  return with_rates(
      {.frame_index = frame, .time = time_of(frame), .rate_commanded_dps = label_dps, .counted = true}, 7.0F,
      8.0F, 9.0F, 0.5F);
}

TEST(FinalisedRows, HaveTheLabelsOfTheFinishedSessionAndWhatWasSaidThen) {
  const std::vector<EstimateRow> rows{journal_row(5)};
  const FinalisedRows finalised = finalised_rows(rows, finished(), 3, period_s);
  ASSERT_EQ(finalised.rows.size(), 1U);
  EXPECT_EQ(finalised.rows[0].rate_commanded_dps, 104.0F);
  EXPECT_EQ(gyro_dps(finalised.rows[0]), 7.0F);
  EXPECT_EQ(thermal_dps(finalised.rows[0]), 8.0F);
  EXPECT_EQ(fusion_dps(finalised.rows[0]), 9.0F);
  EXPECT_TRUE(finalised.rows[0].counted);
}

TEST(FinalisedRows, TellHowFarTheLabelsWere) {
  const std::vector<EstimateRow> rows{journal_row(5, 103.0F),
                                      journal_row(6, 108.0F)};  // finalised: 104 and 105
  const FinalisedRows finalised = finalised_rows(rows, finished(), 3, period_s);
  EXPECT_EQ(finalised.compared, 2U);
  EXPECT_DOUBLE_EQ(finalised.label_difference_mean_dps, -1.0);
  EXPECT_DOUBLE_EQ(finalised.label_difference_max_dps, 3.0);
}

TEST(FinalisedRows, CountWhereTheLiveRunCounted) {
  std::vector<EstimateRow> rows{journal_row(4), journal_row(5), journal_row(6)};
  rows[1].counted = false;
  const FinalisedRows finalised = finalised_rows(rows, finished(), 3, period_s);
  EXPECT_TRUE(finalised.rows[0].counted);  // although the finished session has no window there
  EXPECT_FALSE(finalised.rows[1].counted);
  EXPECT_EQ(finalised.compared, 2U);
  EXPECT_EQ(finalised.windows, 5U);
  EXPECT_EQ(finalised.counted_in_both, 1U);
}

TEST(FinalisedRows, KnowNothingOfFramesThatTheSessionHasNot) {
  const std::vector<EstimateRow> rows{journal_row(1), journal_row(10), journal_row(4'294'967'295U),
                                      journal_row(5, unknown_dps)};
  const FinalisedRows finalised = finalised_rows(rows, finished(), 3, period_s);
  EXPECT_EQ(finalised.compared, 0U);
  EXPECT_TRUE(std::isnan(finalised.label_difference_mean_dps));
  EXPECT_TRUE(std::isnan(finalised.label_difference_max_dps));
  for (const EstimateRow& each : finalised.rows) EXPECT_FALSE(each.counted);
}

TEST(FinalisedRows, AreNotJoinedToFramesOfACameraThatCameBack) {
  std::vector<EstimateRow> rows{journal_row(5), journal_row(6), journal_row(7), journal_row(8)};
  rows[1].time += from_s(0.49 * period_s);  // what a running recorder knows
  rows[2].time += from_s(0.51 * period_s);
  rows[3].time -= from_s(10.0);  // stood in for a frame that never came
  const FinalisedRows finalised = finalised_rows(rows, finished(), 3, period_s);
  EXPECT_EQ(finalised.compared, 2U);
  EXPECT_EQ(finalised.counted_in_both, 2U);
  EXPECT_EQ(finalised.rows[1].rate_commanded_dps, 105.0F);
  for (const std::size_t i : {2U, 3U}) {
    EXPECT_TRUE(std::isnan(finalised.rows[i].rate_commanded_dps));
    EXPECT_FALSE(finalised.rows[i].counted);
  }
}

TEST(FinalisedRows, OfNothingAreNone) {
  EXPECT_TRUE(finalised_rows({}, {}, 1, period_s).rows.empty());
}

}  // namespace
}  // namespace thermorig::live
