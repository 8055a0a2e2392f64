// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "scan.h"
#include "thermorig/sensors/wire/camera_scanner.h"
#include "thermorig/sensors/wire/device_bytes.h"

namespace thermorig::test {

/// Temperatures in hundredths, so that encoding and decoding give exactly the same floats.
inline ThermalFrame frame_of_noise(std::uint64_t seed, int low_cdeg = -4000, int high_cdeg = 30000) {
  std::mt19937_64 random(seed);
  const auto draw = [&] {
    const auto range = static_cast<std::uint64_t>(high_cdeg - low_cdeg + 1);
    return static_cast<float>(low_cdeg + static_cast<int>(random() % range)) / 100.0F;
  };
  ThermalFrame frame;
  for (float& temp_c : frame.temp_c) temp_c = draw();
  frame.sensor_temp_c = draw();
  return frame;
}

inline ThermalFrame uniform_frame(float temp_c) {
  ThermalFrame frame;
  frame.temp_c.fill(temp_c);
  frame.sensor_temp_c = temp_c;
  return frame;
}

inline bool same_frame(const ThermalFrame& a, const ThermalFrame& b) {
  return a.temp_c == b.temp_c && a.sensor_temp_c == b.sensor_temp_c;
}

inline Scan<wire::CameraMessage> scan_camera(ByteSpan bytes, ChecksumPolicy checksum = ChecksumPolicy::word,
                                             Stream stream = Stream::goes_on) {
  return scan_any_chunking<wire::CameraMessage>(wire::CameraScanner(checksum), bytes, stream);
}

/// Bytes of the given frames back to back.
inline ByteVector camera_stream(const std::vector<ThermalFrame>& frames) {
  ByteVector bytes;
  for (const ThermalFrame& frame : frames) append(bytes, wire::camera_frame(frame));
  return bytes;
}

}  // namespace thermorig::test
