// SPDX-License-Identifier: MIT
#include "thermorig/core/nearest_name.h"

#include <gtest/gtest.h>

#include <vector>

namespace thermorig {
namespace {

const std::vector<std::string> names{"witmotion", "text", "mavlink"};

TEST(NearestName, IsTheOneWithFewEdits) {
  EXPECT_EQ(advice_on_name("witmoton", names),
            "did you mean \"witmotion\"? one of: witmotion, text, mavlink");
  EXPECT_EQ(advice_on_name("maflink", names), "did you mean \"mavlink\"? one of: mavlink, text, witmotion");
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
}  // namespace thermorig
