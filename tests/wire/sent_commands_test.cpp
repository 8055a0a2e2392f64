// SPDX-License-Identifier: MIT
#include "thermorig/sensors/wire/sent_commands.h"

#include <gtest/gtest.h>

#include <initializer_list>

#include "thermorig/sensors/wire/servo_messages.h"

namespace thermorig::wire {
namespace {

std::vector<std::uint8_t> joined(std::initializer_list<std::vector<std::uint8_t>> frames) {
  std::vector<std::uint8_t> bytes;
  for (const auto& frame : frames) bytes.insert(bytes.end(), frame.begin(), frame.end());
  return bytes;
}

std::vector<std::string> texts(std::span<const std::uint8_t> bytes) {
  std::vector<std::string> result;
  for (const SentFrame& frame : read_sent(bytes))
    if (is_command(frame)) result.push_back(command_text(frame));
  return result;
}

TEST(SentCommands, ReadAsSentences) {
  const auto bytes = joined(
      {hello_bytes(0), configure_bytes(1, ServoProfile{}), arm_bytes(2, -12.5), refresh_bytes(),
       go_to_bytes(3, {.angle_deg = -712.5, .rate_dps = 200, .acceleration_dps2 = 2000}), ping_bytes(7, 3000),
       run_bytes(
           4, {.leg = 3, .turn_back = true, .rate_dps = -90, .acceleration_dps2 = 2000, .duration_s = 7.7}),
       stop_bytes(), halt_bytes(5), disarm_bytes(6)});
  EXPECT_EQ(
      texts(bytes),
      (std::vector<std::string>{
          "hello of version 1 (sequence 0)",
          "configure a positional servo, 500 to 2500 us over 2160.00 deg, at most 220.00 deg/s and 2000 "
          "deg/s^2 (sequence 1)",
          "arm at -12.50 deg (sequence 2)", "go to -712.50 deg at 200.00 deg/s, 2000 deg/s^2 (sequence 3)",
          "run leg 3 at -90.00 deg/s, 2000 deg/s^2, for 7.70 s, turning back at the limits (sequence 4)",
          "stop byte", "halt (sequence 5)", "disarm (sequence 6)"}));
}

TEST(SentCommands, StandWhereTheirBytesStand) {
  const auto hello = hello_bytes(0);
  const auto bytes = joined({hello, stop_bytes(), arm_bytes(1, 0)});
  const auto frames = read_sent(bytes);
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(frames[0].span, (StreamSpan{0, hello.size()}));
  EXPECT_EQ(frames[1].span, (StreamSpan{hello.size(), hello.size() + 1}));
  EXPECT_EQ(frames[2].span, (StreamSpan{hello.size() + 1, bytes.size()}));
}

TEST(SentCommands, PassOverWhatIsNoWholeFrame) {
  auto bytes = joined({hello_bytes(0), arm_bytes(1, 0)});
  bytes[3] ^= 0x40U;  // damages the hello
  bytes.pop_back();
  EXPECT_TRUE(read_sent(bytes).empty());
}

}  // namespace
}  // namespace thermorig::wire
