// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "gy_mcu90640.h"
#include "thermorig/core/frame.h"
#include "witmotion.h"

namespace thermorig::wire {

// What the vendors' devices send, made by us: for the simulator and for tests. The layouts are those of
// protocols/gy_mcu90640.md, witmotion.md and text_gyro.md.

inline constexpr std::size_t camera_frame_bytes = gy_mcu90640::frame_bytes;
inline constexpr std::size_t witmotion_packet_bytes = witmotion::packet_bytes;

/// One GY-MCU90640 frame. Temperatures are rounded to hundredths and clipped to int16.
std::vector<std::uint8_t> camera_frame(const ThermalFrame& frame);

/// One WitMotion packet of the given type; `words` are d0..d7 as four signed numbers.
std::array<std::uint8_t, witmotion_packet_bytes> witmotion_packet(std::uint8_t type,
                                                                  const std::array<std::int16_t, 4>& words);

/// A WitMotion gyro packet from counts and the temperature in degrees Celsius.
std::array<std::uint8_t, witmotion_packet_bytes> witmotion_gyro_packet(
    const std::array<std::int16_t, 3>& counts, float temp_c);

/// Degrees per second of one WitMotion count.
inline constexpr double witmotion_dps_per_count = witmotion::full_scale_dps / witmotion::counts_full_scale;

}  // namespace thermorig::wire
