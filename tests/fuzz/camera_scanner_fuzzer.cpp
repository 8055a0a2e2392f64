// SPDX-License-Identifier: MIT
#include "scanner_fuzz.h"
#include "thermorig/sensors/wire/device_bytes.h"

/// Every checksum policy on any bytes; and a good frame behind them must come out, whatever they were.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace thermorig;
  const test::ByteSpan input(data, size);
  constexpr std::size_t pending_max = wire::camera_frame_bytes + 4;
  for (const auto policy : {ChecksumPolicy::word, ChecksumPolicy::byte, ChecksumPolicy::ignore})
    test::fuzz_scanner<wire::CameraMessage>(wire::CameraScanner(policy), input, pending_max);

  wire::CameraScanner scanner;
  std::vector<wire::CameraMessage> messages;
  scanner.push(input, messages);
  const std::size_t before = messages.size();
  for (int i = 0; i < 3; ++i) scanner.push(wire::camera_frame(ThermalFrame{}), messages);
  test::require(messages.size() > before, "frames behind garbage are found");
  return 0;
}
