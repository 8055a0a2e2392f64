// SPDX-License-Identifier: MIT
#include "fit/ping_exchanges.h"

#include <gtest/gtest.h>

#include <limits>

namespace thermorig::fit {

using namespace pipeline;

namespace {

/// An exchange that was away for `away_ms`, `held_us` of them with the servo.
timing::PingBound exchange(double away_ms, std::int64_t held_us) {
  return {.receive_us = 1'000'000,
          .not_before = HostTime(from_s(5.0)),
          .send_us = 1'000'000 + held_us,
          .not_after = HostTime(from_s(5.0 + 1e-3 * away_ms))};
}

TEST(ShortestRoundTrip, LeavesOutWhatTheServoHeldBack) {
  EXPECT_NEAR(shortest_round_trip_s({exchange(6.0, 1000), exchange(7.0, 2900), exchange(9.0, 0)}).value(),
              0.0041, 1e-9);
}

TEST(ShortestRoundTrip, IsUnknownWithoutAnAnswerThatAClockExplains) {
  constexpr std::int64_t most = std::numeric_limits<std::int64_t>::max();
  EXPECT_FALSE(shortest_round_trip_s({}));
  EXPECT_FALSE(shortest_round_trip_s({exchange(1.0, 2000), exchange(1.0, -5)}));
  EXPECT_FALSE(shortest_round_trip_s({{most, host_time_ns(most), -most, host_time_ns(-most)}}));
}

}  // namespace
}  // namespace thermorig::fit
