// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "thermorig/core/profile.h"

namespace thermorig::bench {

/// What a device sends that somebody may own: of the form that its published source or document says, with
/// values that are made up.
struct DeviceLayout {
  std::string name;
  Device device = Device::gyro;
  std::function<std::string(int)> message;  // all bytes around the i-th frame or sample
  std::string above = "";                   // that come once
  std::string refusal = "";  // what has to be said of it, as it cannot be recorded; empty: it can
  std::optional<TextColumns> answer = {};  // of lines whose words do not say how they are read: a person's
  double tolerance = 1e-3;                 // half of its resolution, deg/s or K
  std::string sketch = "";                 // under which name it is recognised
  double rate_hz = 100.0;                  // nominal
};

/// The i-th sample, deg/s about x, y, z: each differs from those near it by 3 deg/s or more.
std::array<double, 3> rates_dps(int sample);

/// degC of a pixel; no two frames of twelve are alike.
double temperature_c(int frame, std::size_t pixel);

/// Cameras as sketches and bridges send them.
std::vector<DeviceLayout> camera_layouts();
/// Gyros that print text, those that frame their samples, and what cannot be recorded of either.
std::vector<DeviceLayout> gyro_layouts();

}  // namespace thermorig::bench
