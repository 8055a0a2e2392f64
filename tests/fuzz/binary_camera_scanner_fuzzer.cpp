// SPDX-License-Identifier: MIT
#include "camera_fuzz.h"

/// Any bytes: 768 finite temperatures a frame or none.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const thermorig::test::FuzzedCamera camera("binary", {data, size}, 3092 + 6);
  return 0;
}
