// SPDX-License-Identifier: MIT
#include <cmath>

#include "scanner_fuzz.h"
#include "thermorig/sensors/camera_protocol.h"

/// Any bytes: 768 finite temperatures a frame or none.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace thermorig;
  const test::ByteSpan input(data, size);
  CameraProfile profile;
  profile.protocol = "mlx-raw";
  test::fuzz_scanner<wire::CameraMessage>(sensors::camera_scanner(profile), input, 1700);
  sensors::CameraScanner scanner = sensors::camera_scanner(profile);
  std::vector<wire::CameraMessage> messages;
  scanner.push(input, messages);
  for (const auto& message : messages)
    for (const float temp_c : message.frame.temp_c)
      test::require(std::isfinite(temp_c), "temperatures are finite");
  return 0;
}
