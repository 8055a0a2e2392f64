// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "thermorig/sensors/wire/servo_messages.h"

namespace thermorig::test {
namespace {

TEST(ServoCommandsDeathTest, AbortOnValuesThatDoNotFitTheirField) {
  testing::GTEST_FLAG(death_test_style) = "threadsafe";
  wire::RunCommand run{.rate_dps = 10, .acceleration_dps2 = 70000, .duration_s = 1};
  EXPECT_DEATH(wire::run_bytes(1, run), "acceleration_dps2 = 70000");
  EXPECT_DEATH(wire::arm_bytes(1, std::numeric_limits<double>::quiet_NaN()), "angle_cdeg");
  EXPECT_DEATH(wire::go_to_bytes(1, {.angle_deg = 0, .rate_dps = -1, .acceleration_dps2 = 1}), "rate_cdps");
  ServoProfile servo;
  servo.travel_deg = -1;
  EXPECT_DEATH(wire::configure_bytes(1, servo), "span");
}

TEST(ServoCommands, RoundToTheNearestUnitOfTheLink) {
  const wire::RunCommand exact{.rate_dps = 7.5, .acceleration_dps2 = 1000, .duration_s = 1.234};
  const wire::RunCommand near{.rate_dps = 7.5004, .acceleration_dps2 = 1000.4, .duration_s = 1.2344};
  EXPECT_EQ(wire::run_bytes(1, near), wire::run_bytes(1, exact));
}

TEST(ServoCommands, StopIsOneRawByte) {
  EXPECT_EQ(wire::stop_bytes(), std::vector<std::uint8_t>{SERVO_LINK_STOP});
}

TEST(ServoTexts, NameWhatTheyKnowAndTheNumberOfWhatTheyDoNot) {
  EXPECT_EQ(wire::command_name(SERVO_GO_TO), "go_to");
  EXPECT_EQ(wire::command_name(0x77), "unknown command 119");
  EXPECT_EQ(wire::reason_text(SERVO_REASON_BEYOND_LIMIT),
            "the angle, rate, acceleration or duration lies beyond a limit");
  EXPECT_EQ(wire::reason_text(200), "unknown reason 200");
}

TEST(ServoTexts, TellEventsInWords) {
  EXPECT_EQ(wire::event_text({.kind = SERVO_EVENT_RESET, .detail = 0x06}),
            "the servo's controller was reset (reset pin, brown-out)");
  EXPECT_EQ(wire::event_text({.kind = SERVO_EVENT_FAULT, .detail = SERVO_FAULT_WATCHDOG}),
            "watchdog tripped: no frame from the host for 120 ms");
  EXPECT_EQ(wire::event_text({.kind = SERVO_EVENT_REVERSAL, .detail = 12}), "leg 12: turned back at a limit");
  EXPECT_EQ(wire::event_text({.kind = 77, .detail = 3}), "unknown event 77 (detail 3)");
}

TEST(ServoTexts, NameEveryCauseOfAReset) {
  const auto reset = [](std::uint16_t cause) {
    return wire::event_text({.kind = SERVO_EVENT_RESET, .detail = cause});
  };
  EXPECT_EQ(reset(0x01), "the servo's controller was reset (power-on)");
  EXPECT_EQ(reset(0x0F), "the servo's controller was reset (power-on, reset pin, brown-out, hung firmware)");
  EXPECT_EQ(reset(0x80), "the servo's controller was reset (unknown cause 128)");
}

TEST(ServoTexts, NameEveryFaultAndTheEndsOfALeg) {
  const auto fault = [](std::uint16_t number) {
    return wire::event_text({.kind = SERVO_EVENT_FAULT, .detail = number});
  };
  EXPECT_EQ(fault(SERVO_FAULT_NONE), "no fault");
  EXPECT_EQ(fault(SERVO_FAULT_STOP_BYTE), "stopped by a stop byte");
  EXPECT_EQ(fault(SERVO_FAULT_LIMIT), "an angle limit was reached");
  EXPECT_EQ(fault(SERVO_FAULT_BAD_FRAMES), "three damaged frames in a row");
  EXPECT_EQ(fault(99), "unknown fault 99");
  EXPECT_EQ(wire::event_text({.kind = SERVO_EVENT_LEG_START, .detail = 4}), "leg 4: commanded speed reached");
  EXPECT_EQ(wire::event_text({.kind = SERVO_EVENT_LEG_END, .detail = 4}), "leg 4: motion ended");
}

TEST(ServoTexts, DifferForEveryReasonAndCommand) {
  std::vector<std::string> texts;
  for (std::uint8_t reason = SERVO_REASON_UNKNOWN_TYPE; reason <= SERVO_REASON_BAD_VALUE; ++reason)
    texts.push_back(wire::reason_text(reason));
  for (std::uint8_t type = SERVO_HELLO; type <= SERVO_PING; ++type) texts.push_back(wire::command_name(type));
  for (const std::string& text : texts) {
    EXPECT_EQ(std::count(texts.begin(), texts.end(), text), 1) << text;
    EXPECT_EQ(text.find("unknown"), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace thermorig::test
