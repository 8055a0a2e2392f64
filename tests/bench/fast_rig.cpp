// SPDX-License-Identifier: MIT
#include "fast_rig.h"

#include "timing_rig.h"

namespace thermorig::bench {

simulation::VirtualRigConfig fast_rig() {
  constexpr double camera_hz = 64.0, gyro_hz = 1000.0;
  const TableLink link = table_links(false).back();  // CDC
  simulation::VirtualRigConfig config = rig_on(link, 1);
  config.profile.camera.output_rate_hz = camera_hz;
  config.profile.gyro.output_rate_hz = gyro_hz;
  config.profile.camera.link.latency_s = *(config.camera_latency_s = 0.010);
  config.profile.gyro.link.latency_s = 0.5 / gyro_hz + *(config.gyro_latency_s = 0.001);
  return config;
}

}  // namespace thermorig::bench
