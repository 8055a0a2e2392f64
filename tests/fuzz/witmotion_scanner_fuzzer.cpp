// SPDX-License-Identifier: MIT
#include "../support/gyro_scanners.h"
#include "scanner_fuzz.h"
#include "thermorig/sensors/wire/device_bytes.h"

/// Any bytes; and good packets behind them must come out, whatever they were.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace thermorig;
  const test::ByteSpan input(data, size);
  test::fuzz_scanner<wire::GyroMessage>(test::witmotion_scanner(), input, 2 * wire::witmotion_packet_bytes);

  sensors::GyroScanner scanner = test::witmotion_scanner();
  std::vector<wire::GyroMessage> messages;
  scanner.push(input, messages);
  const std::size_t before = messages.size();
  for (int i = 0; i < 6; ++i) scanner.push(wire::witmotion_gyro_packet({1, 2, 3}, 25.0F), messages);
  test::require(messages.size() > before, "packets behind garbage are found");
  return 0;
}
