// SPDX-License-Identifier: MIT
#include <cmath>

#include "../support/gyro_scanners.h"
#include "scanner_fuzz.h"
#include "thermorig/sensors/gyro_sketch.h"
#include "thermorig/sensors/text_format.h"

namespace {

void require_finite(const thermorig::sensors::GyroScanner& fresh, thermorig::test::ByteSpan input) {
  thermorig::sensors::GyroScanner scanner = fresh;
  std::vector<thermorig::wire::GyroMessage> messages;
  scanner.push(input, messages);
  for (const auto& message : messages)
    for (const float rate_dps : message.reading.rate_dps)
      thermorig::test::require(std::isfinite(rate_dps), "rates are finite");
}

/// A format that is guessed names columns that are there, and its scale is a number.
void require_format_fits(thermorig::test::ByteSpan input) {
  using thermorig::test::require;
  const auto format = thermorig::sensors::guess_text_format(input);
  if (!format || !format->refusal.empty()) return;
  const auto fields = static_cast<int>(format->fields);
  for (const int column : format->columns.rate)
    require(column >= -1 && column < fields, "a rate has a column, or is not sent");
  require(format->columns.time < fields, "the time has a column");
  require(format->lines >= 2 && format->bytes <= input.size(), "it comes from lines of the input");
  require(format->sample_line.find(format->columns.prefix) != std::string::npos, "the line has the prefix");
}

}  // namespace

/// Any text or bytes, with and without a prefix, device time, scale and sketch.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace thermorig;
  const test::ByteSpan input(data, size);
  constexpr std::size_t pending_max =
      2 * (sensors::text_line_bytes_max + 2);  // two lines, while their number of columns is learnt
  TextColumns timed;
  timed.prefix = "a/g:";
  timed.rate = {3, 4, -1};
  timed.scale_dps = 1.0 / 131.0;
  timed.time = 0;
  for (const TextColumns& columns : {TextColumns{}, timed}) {
    for (const auto start : {sensors::StreamStart::anywhere, sensors::StreamStart::at_line_start}) {
      const sensors::GyroScanner scanner = test::text_scanner(columns, start);
      test::fuzz_scanner<wire::GyroMessage>(scanner, input, pending_max);
      require_finite(scanner, input);
    }
  }
  GyroProfile named;  // the words on the first lines are held against it
  sensors::choose_gyro("sparkfun-bno080", named);
  test::fuzz_scanner<wire::GyroMessage>(sensors::gyro_scanner(named), input, pending_max);
  require_format_fits(input);
  return 0;
}
