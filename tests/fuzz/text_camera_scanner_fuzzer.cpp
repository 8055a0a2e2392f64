// SPDX-License-Identifier: MIT
#include <string>

#include "camera_fuzz.h"

/// Any text or bytes: 768 finite temperatures a frame or none; and frames behind them come out.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace thermorig;
  constexpr std::size_t pending_max = std::size_t{frame_rows + 1} * frame_pixels * 26;
  test::FuzzedCamera camera("text", {data, size}, pending_max);
  const std::size_t before = camera.messages.size();
  std::string frame = "\n\n";
  for (std::size_t pixel = 0; pixel < frame_pixels; ++pixel) frame += "23.4,";
  frame += "\n";
  camera.scanner.push({reinterpret_cast<const std::uint8_t*>(frame.data()), frame.size()}, camera.messages);
  test::require(camera.messages.size() > before, "a frame behind garbage is found");
  return 0;
}
