// SPDX-License-Identifier: MIT
#include "thermorig/storage/session/servo_rests.h"

namespace thermorig::session {

namespace {

constexpr auto coming_to_rest = std::chrono::seconds(1);

}  // namespace

std::vector<Rest> servo_rests(std::span<const TimedServo> servo) {
  std::vector<Rest> rests;
  bool resting = false;
  for (const TimedServo& message : servo) {
    const bool still = is_at_rest(message.state);
    if (still && !resting) rests.push_back({message.stamp.time + coming_to_rest, message.stamp.time});
    if (still) rests.back().end = message.stamp.time;
    resting = still;
  }
  std::erase_if(rests, [](const Rest& rest) { return rest.end <= rest.begin; });
  return rests;
}

}  // namespace thermorig::session
