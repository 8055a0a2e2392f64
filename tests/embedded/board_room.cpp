// SPDX-License-Identifier: MIT
#include "board_room.h"

#include "board_odometer.h"
#include "support/at_s.h"

namespace thermorig::tests {

odometer::Room turning_room(double duration_s) {
  odometer::Room room;
  room.duration_s = duration_s;
  room.angle_deg = odometer::to_and_fro(200.0, 60.0);
  return room;
}

std::string recording_of(const std::vector<odometer::Seen>& all, const RigProfile& rig) {
  std::string bytes;
  for (const odometer::Seen& seen : all)
    BoardFrame(seen.frame, seen.gyro, rig.gyro, at_s(-1.0)).append_to(bytes);
  return bytes;
}

}  // namespace thermorig::tests
