// SPDX-License-Identifier: MIT
#include "thermorig/motion/panorama_fit.h"

namespace thermorig::motion {

std::optional<unsigned> newer_half(std::span<const TimedFrame>, std::span<const TimedGyro>, const View&,
                                   const GyroErrors&) {
  return std::nullopt;
}

TurnResult gyro_scale(std::span<const TimedFrame>, std::span<const TimedGyro>, const View&,
                      const GyroErrors&) {
  return {std::nullopt, 0.0, "image motion was not looked at"};
}

Orientation orientation(std::span<const TimedFrame>, std::span<const TimedGyro>, const View&,
                        const GyroErrors&) {
  return {std::nullopt, 0.0, "image motion was not looked at"};
}

}  // namespace thermorig::motion
