// SPDX-License-Identifier: MIT
#include <cmath>

#include "../support/vectors.h"
#include "scanner_fuzz.h"
#include "thermorig/sensors/servo_protocol.h"
#include "thermorig/sensors/wire/dynamixel.h"
#include "thermorig/sensors/wire/grbl.h"
#include "thermorig/sensors/wire/sts3215.h"

namespace {

void fuzz(const char* protocol, std::span<const std::uint8_t> telemetry, std::size_t longest,
          thermorig::test::ByteSpan input) {
  using namespace thermorig;
  auto scanner = sensors::servo_protocol(protocol).scanner({});
  test::fuzz_scanner<wire::ServoMessage>(scanner, input, longest + 1);
  scanner.sent(input);
  std::vector<wire::ServoMessage> messages;
  scanner.push(input, messages);
  for (const wire::ServoMessage& message : messages)
    if (const auto* state = std::get_if<ServoState>(&message.body))
      test::require(std::isfinite(state->angle_deg) && std::isfinite(state->rate_dps), "motion is finite");
  const std::size_t before = messages.size();
  for (std::size_t sent = 0; sent < 2 * longest; sent += telemetry.size()) scanner.push(telemetry, messages);
  test::require(messages.size() > before, "telemetry behind garbage is found");
  sensors::servo_protocol(protocol).recognise(input);
}

}  // namespace

/// Any bytes, as answers and as what was sent; and good telemetry behind them must come out.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace thermorig;
  static const std::vector<std::uint8_t> packet = test::read_vectors("dynamixel.txt").front().bytes;
  static const std::vector<std::uint8_t> line = test::read_vectors("grbl.txt").front().bytes;
  static const std::vector<std::uint8_t> short_packet = test::read_vectors("sts3215.txt").front().bytes;
  fuzz("dynamixel", packet, wire::dynamixel::longest_packet, {data, size});
  fuzz("grbl", line, wire::grbl::longest_line, {data, size});
  fuzz("sts3215", short_packet, wire::sts3215::longest_packet, {data, size});
  return 0;
}
