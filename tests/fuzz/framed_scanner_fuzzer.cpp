// SPDX-License-Identifier: MIT
#include <array>
#include <cmath>

#include "../support/vectors.h"
#include "scanner_fuzz.h"
#include "thermorig/sensors/gyro_protocol.h"

namespace {

struct Gyro {
  thermorig::GyroProfile profile;
  std::vector<std::uint8_t> frame;  // a good one: protocols/vectors
  std::size_t longest;
};

std::vector<Gyro> gyros() {
  const auto first = [](const char* file) { return thermorig::test::read_vectors(file).front().bytes; };
  return {{{.protocol = "vectornav"}, first("vectornav.txt"), 256},
          {{.protocol = "xsens"}, first("xsens.txt"), 6 + 2048 + 1},
          {{.protocol = "hipnuc"}, first("hipnuc.txt"), 6 + 512},
          {{.protocol = "mip"}, first("mip.txt"), 4 + 255 + 2}};
}

}  // namespace

/// Any bytes; and good frames behind them must come out, whatever they were.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace thermorig;
  static const std::vector<Gyro> all = gyros();
  const test::ByteSpan input(data, size);
  for (const Gyro& gyro : all) {
    auto scanner = sensors::gyro_scanner(gyro.profile);
    test::fuzz_scanner<wire::GyroMessage>(scanner, input, gyro.longest + 1);
    std::vector<wire::GyroMessage> messages;
    scanner.push(input, messages);
    for (const wire::GyroMessage& message : messages) {
      for (const float rate_dps : message.reading.rate_dps)
        test::require(std::isfinite(rate_dps), "rates are finite");
      test::require(message.reading.device_time_us.value_or(0) >= 0, "no time is before 0");
    }
    const std::size_t before = messages.size();
    for (std::size_t sent = 0; sent < 2 * gyro.longest; sent += gyro.frame.size())
      scanner.push(gyro.frame, messages);
    test::require(messages.size() > before, "frames behind garbage are found");
    sensors::gyro_protocol(gyro.profile.protocol).recognise(input, 1.0);
  }
  return 0;
}
