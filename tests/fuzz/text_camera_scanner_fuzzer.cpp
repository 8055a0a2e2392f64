// SPDX-License-Identifier: MIT
#include <cmath>

#include "scanner_fuzz.h"
#include "thermorig/sensors/camera_protocol.h"

/// Any text or bytes: 768 finite temperatures a frame or none; and frames behind them come out.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace thermorig;
  const test::ByteSpan input(data, size);
  CameraProfile profile;
  profile.protocol = "text";
  constexpr std::size_t pending_max = std::size_t{frame_rows + 1} * frame_pixels * 26;
  test::fuzz_scanner<wire::CameraMessage>(sensors::camera_scanner(profile), input, pending_max);

  sensors::CameraScanner scanner = sensors::camera_scanner(profile);
  std::vector<wire::CameraMessage> messages;
  scanner.push(input, messages);
  for (const auto& message : messages)
    for (const float temp_c : message.frame.temp_c)
      test::require(std::isfinite(temp_c), "temperatures are finite");
  const std::size_t before = messages.size();
  std::string frame = "\n\n";
  for (std::size_t pixel = 0; pixel < frame_pixels; ++pixel) frame += "23.4,";
  frame += "\n";
  scanner.push({reinterpret_cast<const std::uint8_t*>(frame.data()), frame.size()}, messages);
  test::require(messages.size() > before, "a frame behind garbage is found");
  return 0;
}
