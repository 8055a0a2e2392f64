// SPDX-License-Identifier: MIT
#include "board_room.h"

#include <random>

#include "board_odometer.h"
#include "support/at_s.h"

namespace thermorig::tests {

odometer::Room turning_room(double duration_s) {
  odometer::Room room;
  room.duration_s = duration_s;
  room.angle_deg = odometer::to_and_fro(200.0, 60.0);
  return room;
}

void shake(std::vector<odometer::Seen>& all) {
  std::mt19937 random(5);
  std::normal_distribution<float> shake_dps(0.0F, 3.0F);
  for (odometer::Seen& seen : all)
    for (TimedGyro& sample : seen.gyro) {
      sample.rate_dps += shake_dps(random);
      sample.reading.rate_dps = {shake_dps(random), shake_dps(random), sample.rate_dps};
    }
}

std::string recording_of(const std::vector<odometer::Seen>& all, const RigProfile& rig) {
  std::string bytes;
  for (const odometer::Seen& seen : all)
    BoardFrame(seen.frame, seen.gyro, rig.gyro, at_s(-1.0)).append_to(bytes);
  return bytes;
}

}  // namespace thermorig::tests
