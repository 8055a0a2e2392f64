// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "bench.h"

namespace thermorig::firmware_test {
namespace {

using simulation::SensorBus;
using simulation::SensorRegisters;

constexpr std::uint8_t good_magnet = SERVO_SHAFT_MAGNET_FOUND;

class ServoEncoder : public FirmwareTest {
 protected:
  /// HELLO that asks for the shaft.
  void ask() {
    bench().next_sequence = 0;
    EXPECT_EQ(bench().command(SERVO_HELLO, {SERVO_LINK_VERSION, SERVO_ASK_SHAFT}).type, SERVO_WELCOME);
  }
  void configure_and_arm() {
    EXPECT_EQ(bench().command(SERVO_CONFIGURE, payload_of(winch())).type, SERVO_ACK);
    EXPECT_EQ(bench().command(SERVO_ARM, payload_of(servo_arm{0})).type, SERVO_ACK);
  }
  int count_of(std::uint8_t status) {
    return static_cast<int>(
        std::ranges::count_if(bench().shaft(), [&](const servo_shaft& one) { return one.status == status; }));
  }
};

TEST_P(ServoEncoder, IsLeftAloneUntilTheHostAsks) {
  bench().sense({.status = good_magnet, .raw = 7});
  bench().hello();
  bench().run_for(300'000);
  EXPECT_TRUE(bench().shaft().empty());
  EXPECT_TRUE(bench().writes().empty());
}

TEST_P(ServoEncoder, WhereNoneAnswersNothingIsSent) {
  ask();
  bench().run_for(300'000);
  EXPECT_TRUE(bench().shaft().empty());
  EXPECT_NEAR(static_cast<double>(bench().telemetry().size()), 31.0, 2.0);
  EXPECT_EQ(bench().damaged, 0);
}

TEST_P(ServoEncoder, IsReadFiveHundredTimesASecond) {
  bench().sense({.status = good_magnet, .raw = 4095, .gain = 77});
  ask();
  bench().run_for(1'000'000);
  const auto& shaft = bench().shaft();
  ASSERT_NEAR(static_cast<double>(shaft.size()), 500.0, 20.0);
  for (std::size_t i = 1; i < shaft.size(); ++i)
    EXPECT_NEAR(shaft[i].mcu_us - shaft[i - 1].mcu_us, 2000, 1100);
  EXPECT_EQ(shaft.back().raw, 4095);
  EXPECT_EQ(shaft.back().status, good_magnet);
  EXPECT_EQ(shaft.back().gain, 77);
}

TEST_P(ServoEncoder, OnlyItsConfigurationIsWritten) {
  bench().sense({.status = good_magnet});
  ask();
  bench().run_for(1'000'000);
  ASSERT_EQ(bench().writes().size(), 2U);
  EXPECT_EQ(bench().writes()[0].address, 0x07);
  EXPECT_EQ(bench().writes()[0].value, 0x07);
  EXPECT_EQ(bench().writes()[1].address, 0x08);
  EXPECT_EQ(bench().writes()[1].value, 0x00);
}

TEST_P(ServoEncoder, PulsesAreThoseOfABoardWithoutOne) {
  const auto swept = [&](bool has_encoder) {
    restart();
    if (has_encoder) bench().sense({.status = good_magnet, .raw = 100});
    ask();
    configure_and_arm();
    bench().run_for(200'000 - bench().now_us());  // its answers came sooner or later
    bench().send(frame(SERVO_RUN, bench().next_sequence, payload_of(servo_run{1, 0, 20000, 20000, 400})));
    bench().run_refreshed(500'000);
    return bench().pulses();
  };
  const auto with = swept(true), without = swept(false);
  ASSERT_EQ(with.size(), without.size());
  for (std::size_t i = 0; i < with.size(); ++i) {
    EXPECT_EQ(with[i].rise_us, without[i].rise_us);
    // simavr shows an edge at the end of the instruction in hand
    EXPECT_NEAR(with[i].width_us, without[i].width_us, is_avr() ? 3.0 / SERVO_TICKS_PER_US : 0.0);
  }
}

TEST_P(ServoEncoder, AReadingThatFailsIsNoAngle) {
  bench().sense({.status = good_magnet, .raw = 1000});
  ask();
  bench().run_for(100'000);
  for (const SensorBus bus : {SensorBus::silent, SensorBus::hangs_high}) {
    const int before = count_of(SERVO_SHAFT_UNREAD);
    bench().sense({.bus = bus, .status = good_magnet, .raw = 1000});
    bench().run_for(20'000);
    bench().sense({.status = good_magnet, .raw = 1000});
    bench().run_for(20'000);
    EXPECT_NEAR(count_of(SERVO_SHAFT_UNREAD) - before, 10, 2);
    EXPECT_EQ(bench().shaft().back().status, good_magnet);
  }
  for (const servo_shaft& reading : bench().shaft())
    EXPECT_EQ(reading.raw, reading.status == good_magnet ? 1000 : 0);
}

TEST_P(ServoEncoder, ThatWasAwayIsSetUpAnew) {
  bench().sense({.status = good_magnet});
  ask();
  bench().run_for(100'000);
  bench().sense({.bus = SensorBus::silent});
  bench().run_for(300'000);
  EXPECT_EQ(count_of(SERVO_SHAFT_UNREAD), 50);  // then it is looked for once a second
  bench().sense({.status = good_magnet});
  bench().run_for(1'100'000);
  EXPECT_EQ(bench().shaft().back().status, good_magnet);
  EXPECT_EQ(bench().writes().size(), 4U);
}

INSTANTIATE_TEST_SUITE_P(Both, ServoEncoder, testing::Values(Form::host_build, Form::avr_image),
                         [](const auto& form) {
                           return form.param == Form::host_build ? "HostBuild" : "AvrImage";
                         });

}  // namespace
}  // namespace thermorig::firmware_test
