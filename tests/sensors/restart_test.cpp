// SPDX-License-Identifier: MIT
// What every scanner does when its stream is interrupted.
#include <gtest/gtest.h>

#include <span>
#include <vector>

#include "simulation/gyro.h"
#include "support/same_message.h"
#include "support/telemetry_bytes.h"
#include "thermorig/sensors/camera_protocol.h"
#include "thermorig/sensors/gyro_protocol.h"
#include "thermorig/sensors/servo_protocol.h"
#include "thermorig/sensors/wire/counter_names.h"
#include "thermorig/sensors/wire/device_bytes.h"
#include "thermorig/sensors/wire/servo_messages.h"

namespace thermorig::sensors {
namespace {

using ByteVector = std::vector<std::uint8_t>;

void append(ByteVector& bytes, std::span<const std::uint8_t> more) {
  bytes.insert(bytes.end(), more.begin(), more.end());
}

/// Of two pieces of a stream together.
wire::Counters sum_of(wire::Counters counters, const wire::Counters& others) {
  for (const auto& counter : wire::counter_names) counters.*counter.member += others.*counter.member;
  counters.bytes_in_filler += others.bytes_in_filler;  // which is not stored
  return counters;
}

template <typename Message>
std::vector<Message> messages_of(Scanner<Message>& scanner, std::span<const std::uint8_t> bytes) {
  std::vector<Message> messages;
  scanner.push(bytes, messages);
  scanner.finish(messages);
  return messages;
}

/// As soon as a new one does, byte by byte: it must have forgotten that its stream had ended.
template <typename Message>
void expect_as_early(Scanner<Message> restarted, Scanner<Message> anew, std::span<const std::uint8_t> bytes) {
  std::vector<Message> messages, expected;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    restarted.push(bytes.subspan(i, 1), messages);
    anew.push(bytes.subspan(i, 1), expected);
    ASSERT_EQ(messages.size(), expected.size()) << "after byte " << i;
  }
}

/// A scanner that was restarted gives what a new one gives, its spans behind all bytes so far, its counters
/// on top of what was counted. The first piece ends within a message, the second begins within one.
template <typename Message>
void expect_a_restart_to_begin_anew(const Scanner<Message>& scanner, const ByteVector& bytes) {
  const auto first = std::span(bytes).first(bytes.size() / 2 + 5);
  const auto second = std::span(bytes).subspan(bytes.size() / 3 + 1);
  Scanner<Message> restarted = scanner;
  messages_of(restarted, first);
  restarted.restart();
  expect_as_early(restarted, scanner, second);
  const std::vector<Message> messages = messages_of(restarted, second);

  Scanner<Message> before = scanner;
  messages_of(before, first);
  Scanner<Message> anew = scanner;
  std::vector<Message> expected = messages_of(anew, second);
  ASSERT_GT(expected.size(), 1U);
  ASSERT_EQ(messages.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    expected[i].span.begin += first.size();
    expected[i].span.end += first.size();
    EXPECT_TRUE(test::same(messages[i], expected[i])) << i;
  }
  EXPECT_EQ(restarted.counters(), sum_of(before.counters(), anew.counters()));
}

TEST(Restart, OfAGyrosScannerBeginsAnew) {
  for (const GyroProtocol& protocol : gyro_protocols()) {
    SCOPED_TRACE(protocol.name);
    const GyroProfile profile{.protocol = std::string(protocol.name)};
    ByteVector bytes;
    for (int i = 0; i < 60; ++i) {
      simulation::SimulatedGyroSample sample;
      sample.index = static_cast<std::uint64_t>(i);
      sample.rate_dps = {1.5, -20.0, 0.1 * i};
      append(bytes, simulation::gyro_encoder(profile).bytes(sample, profile));
    }
    expect_a_restart_to_begin_anew(gyro_scanner(profile), bytes);
  }
}

TEST(Restart, OfACamerasScannerBeginsAnew) {
  ByteVector bytes;
  ThermalFrame frame;
  for (int i = 0; i < 8; ++i) {
    for (std::size_t pixel = 0; pixel < frame_pixels; pixel += 2) frame.temp_c[pixel] += 0.25F;
    append(bytes, wire::camera_frame(frame));
  }
  for (const ChecksumPolicy checksum : {ChecksumPolicy::word, ChecksumPolicy::ignore})
    expect_a_restart_to_begin_anew(CameraScanner(wire::CameraScanner(checksum)), bytes);
}

TEST(Restart, OfTheServosScannerBeginsAnew) {
  ByteVector bytes;
  for (std::uint8_t i = 0; i < 40; ++i)
    append(bytes, test::telemetry_bytes(i, {.mcu_us = i * 10'000U, .angle_deg = 0.5 * i}));
  expect_a_restart_to_begin_anew(servo_protocol("servo-link").scanner({}), bytes);
}

}  // namespace
}  // namespace thermorig::sensors
