// SPDX-License-Identifier: MIT
#include "pipeline/timing/lower_line.h"

#include <gtest/gtest.h>

#include <vector>

namespace thermorig::timing {
namespace {

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

}  // namespace
}  // namespace thermorig::timing
