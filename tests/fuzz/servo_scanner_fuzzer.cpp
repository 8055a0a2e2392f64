// SPDX-License-Identifier: MIT
#include "../support/telemetry_bytes.h"
#include "scanner_fuzz.h"

/// Any bytes; telemetry behind them must come out; every event, reason and command has a text.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace thermorig;
  const test::ByteSpan input(data, size);
  test::fuzz_scanner<wire::ServoMessage>(wire::ServoScanner(), input, SERVO_FRAME_MAX + 1);

  wire::ServoScanner scanner;
  std::vector<wire::ServoMessage> messages;
  scanner.push(input, messages);
  for (const wire::ServoMessage& message : messages) {
    if (const auto* event = std::get_if<wire::ServoEvent>(&message.body))
      test::require(!wire::event_text(*event).empty(), "an event has a text");
    if (const auto* nack = std::get_if<wire::ServoNack>(&message.body))
      test::require(!wire::reason_text(nack->reason).empty(), "a reason has a text");
  }
  const std::size_t before = messages.size();
  for (std::uint8_t i = 0; i < 2; ++i) scanner.push(test::telemetry_bytes(i, ServoState{}), messages);
  test::require(messages.size() > before, "frames behind garbage are found");
  return 0;
}
