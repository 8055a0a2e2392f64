// SPDX-License-Identifier: MIT
#include "thermorig/network/soundness.h"

#include <gtest/gtest.h>

#include <limits>

#include "support/synthetic_acquisitions.h"
#include "thermorig/core/frame.h"
#include "thermorig/network/window_index.h"

namespace thermorig::network {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr std::size_t spoilt = 5;  // a frame in the midst of the first leg

class UnsoundFrames : public testing::Test {
 protected:
  std::vector<std::uint32_t> runs_then() {
    clear_unsound_frames(acquisition_);
    return acquisition_.run;
  }
  std::vector<std::uint32_t> runs_without_the_spoilt() const {
    std::vector<std::uint32_t> runs = synthetic::make_acquisition("garden", 1, 3).run;
    runs[spoilt] = 0;
    return runs;
  }
  Acquisition acquisition_ = synthetic::make_acquisition("garden", 1, 3);
};

TEST_F(UnsoundFrames, AreNoneInASoundAcquisition) {
  const auto before = acquisition_.run;
  EXPECT_EQ(runs_then(), before);
}

TEST_F(UnsoundFrames, AreThoseWithoutALabel) {
  acquisition_.label_dps[spoilt] = nan;
  EXPECT_EQ(runs_then(), runs_without_the_spoilt());
}

TEST_F(UnsoundFrames, AreThoseWithoutAGyro) {
  acquisition_.gyro_dps[spoilt] = nan;
  EXPECT_EQ(runs_then(), runs_without_the_spoilt());
}

TEST_F(UnsoundFrames, AreThoseWithSpeedsThatNothingTurnsAt) {
  for (const float rate_dps : {infinity, -infinity, 3e38F, -2e4F}) {
    acquisition_ = synthetic::make_acquisition("garden", 1, 3);
    acquisition_.label_dps[spoilt] = rate_dps;
    EXPECT_EQ(runs_then(), runs_without_the_spoilt()) << rate_dps;
  }
}

TEST_F(UnsoundFrames, AreThoseWithAPixelThatIsNoTemperature) {
  for (const float temp_c : {nan, infinity, -61.0F, 3e38F}) {
    acquisition_ = synthetic::make_acquisition("garden", 1, 3);
    acquisition_.temp_c[spoilt * frame_pixels + 767] = temp_c;
    EXPECT_EQ(runs_then(), runs_without_the_spoilt()) << temp_c;
  }
}

TEST_F(UnsoundFrames, LeaveNoWindowAcrossThem) {
  acquisition_.gyro_dps[spoilt] = nan;
  clear_unsound_frames(acquisition_);
  for (const Window& window : find_windows({&acquisition_, 1}, 3))
    EXPECT_TRUE(window.last < spoilt || window.last >= spoilt + 3);
}

}  // namespace
}  // namespace thermorig::network
