// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "mcap_writer.h"

namespace thermorig::interchange {

/// The channels of a session: images as foxglove.RawImage, rotation as sensor_msgs/Imu, telemetry, labels,
/// events as foxglove.Log, in this order.
std::vector<McapChannel> mcap_channels();

}  // namespace thermorig::interchange
