// SPDX-License-Identifier: MIT
#include "camera_fuzz.h"

/// Any bytes: 768 finite temperatures a frame or none, and at most one half of it is new.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const thermorig::test::FuzzedCamera camera("i2c-stick", {data, size}, 6000);
  for (const auto& message : camera.messages)
    thermorig::test::require(!message.fresh.both_fresh(), "one half at most is new");
  return 0;
}
