// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "mcap_writer.h"

namespace thermorig::interchange {

/// The channels of a session: images as foxglove.RawImage, rotation as sensor_msgs/Imu, telemetry, labels,
/// events as foxglove.Log, in this order; then readings of the shaft, where there are some.
std::vector<McapChannel> mcap_channels(bool has_measured_shaft);

}  // namespace thermorig::interchange
