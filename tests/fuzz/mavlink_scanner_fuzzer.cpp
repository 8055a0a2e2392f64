// SPDX-License-Identifier: MIT
#include <cmath>

#include "../support/gyro_scanners.h"
#include "../support/vectors.h"
#include "scanner_fuzz.h"

namespace {

/// SCALED_IMU of system 1, component 1: protocols/vectors/mavlink_gyro.txt, "scaled_imu".
const std::vector<std::uint8_t> packet = thermorig::test::bytes_from_hex(
    "fd1800000701011a0000e80300000300f9ff18fc640038ff2c01010002000300d0099265");

void require_finite(thermorig::sensors::GyroScanner scanner, thermorig::test::ByteSpan input) {
  std::vector<thermorig::wire::GyroMessage> messages;
  scanner.push(input, messages);
  for (const auto& message : messages) {
    for (const float rate_dps : message.reading.rate_dps)
      thermorig::test::require(std::isfinite(rate_dps), "rates are finite");
    thermorig::test::require(message.reading.device_time_us >= 0, "a sample has its time");
  }
}

}  // namespace

/// Any bytes, with and without a scale of RAW_IMU; and good packets behind them must come out, whatever they
/// were.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace thermorig;
  const test::ByteSpan input(data, size);
  // The longest packet, and behind it the time that a log has there and a sync.
  constexpr std::size_t pending_max = 10 + 255 + 2 + 13 + 8 + 1;
  for (const double raw_scale_dps : {0.0, 0.01}) {
    const auto scanner = sensors::gyro_scanner(
        {.protocol = "mavlink", .settings = {{"raw_scale_dps", raw_scale_dps}, {"message", 0.0}}});
    test::fuzz_scanner<wire::GyroMessage>(scanner, input, pending_max);
    require_finite(scanner, input);
  }

  auto scanner = sensors::gyro_scanner(
      {.protocol = "mavlink", .settings = {{"system", 1.0}, {"component", 1.0}, {"message", 26.0}}});
  std::vector<wire::GyroMessage> messages;
  scanner.push(input, messages);
  const std::size_t before = messages.size();
  for (int i = 0; i < 20; ++i) scanner.push(packet, messages);
  test::require(messages.size() > before, "packets behind garbage are found");
  return 0;
}
