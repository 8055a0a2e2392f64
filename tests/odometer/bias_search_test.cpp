// SPDX-License-Identifier: MIT
#include "estimators/odometer/bias_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "room.h"
#include "support/at_s.h"

namespace thermorig::odometer {
namespace {

/// Of ten spans of 24 halves before faint walls, on a shaft so fast that most of them is swept away: how
/// often a bias is named that is more than 5 deg/s off.
int wrong_biases() {
  constexpr double row_spread = 0.3;
  Room room;
  room.duration_s = 30.0;
  room.contrast_k = 0.3;
  room.scale = 1.0;
  room.rolling = row_spread;
  room.angle_deg = [](double time_s) { return 130.0 * time_s; };
  CameraProfile camera;
  camera.row_spread = row_spread;
  const auto lens = std::make_shared<const Lens>(camera);
  BiasSearch search(Priors(), lens);
  GyroPath path;
  HalfStore store;
  int wrong = 0;
  for (const Seen& seen : seen_in(room)) {
    for (const TimedGyro& sample : seen.gyro)
      path.add(to_s(sample.stamp.time - at_s(0.0)), double{sample.rate_dps}, 0.0);
    const auto half = half_of(seen.frame, seen.frame.fresh_even > 0 ? 0U : 1U, at_s(0.0));
    if (!half || half->begin_s < path.begin_s()) continue;
    store.add(*half, half->end_s);
    if (store.count() < BiasSearch::halves) continue;
    const auto found = search.search(store, path, lens->rows());
    if (found && std::abs(found->bias_dps - room.bias_dps) > 5.0) ++wrong;
    store.clear();
  }
  return wrong;
}

TEST(BiasSearch, RatherWaitsThanNamesAWrongBiasWhereTheOrderOfRowsIsKnown) {
  EXPECT_EQ(wrong_biases(), 0);
}

}  // namespace
}  // namespace thermorig::odometer
