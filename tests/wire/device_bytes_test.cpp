// SPDX-License-Identifier: MIT
#include "thermorig/sensors/wire/device_bytes.h"

#include <gtest/gtest.h>

#include "camera_stream.h"

namespace thermorig::test {
namespace {

TEST(DeviceBytes, RoundTemperaturesToHundredths) {
  ThermalFrame frame = uniform_frame(20.0F);
  frame.temp_c[0] = 21.4449F;
  frame.temp_c[1] = -0.0051F;
  const auto scan = scan_camera(wire::camera_frame(frame));
  ASSERT_EQ(scan.messages.size(), 1U);
  EXPECT_FLOAT_EQ(scan.messages[0].frame.temp_c[0], 21.44F);
  EXPECT_FLOAT_EQ(scan.messages[0].frame.temp_c[1], -0.01F);
}

TEST(DeviceBytes, ClipTemperaturesThatDoNotFit) {
  const auto scan = scan_camera(camera_stream({uniform_frame(1000.0F), uniform_frame(-1000.0F)}));
  ASSERT_EQ(scan.messages.size(), 2U);
  EXPECT_FLOAT_EQ(scan.messages[0].frame.temp_c[5], 327.67F);
  EXPECT_FLOAT_EQ(scan.messages[1].frame.temp_c[5], -327.68F);
}

}  // namespace
}  // namespace thermorig::test
