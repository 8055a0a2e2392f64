// SPDX-License-Identifier: MIT
// What is sent to servos that do not carry our firmware: packets of Dynamixel and Feetech, lines of GRBL.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "thermorig/sensors/wire/dynamixel.h"
#include "thermorig/sensors/wire/grbl.h"
#include "thermorig/sensors/wire/sts3215.h"

namespace thermorig::test::bus_servo_words {
namespace {

namespace dynamixel = wire::dynamixel;
namespace grbl = wire::grbl;
namespace sts3215 = wire::sts3215;
using Bytes = std::vector<std::uint8_t>;

TEST(Grbl, AJogThatIsSentReadsBackWithItsLeg) {
  const Bytes line = grbl::jog_line({-6.25, 30.0, 12});
  EXPECT_EQ(std::string(line.begin(), line.end()), "$J=G91X-6.250F1800.0(leg 12)\n");
  const auto jog = grbl::parse_jog("$J=G91X-6.250F1800.0(leg 12)");
  ASSERT_TRUE(jog);
  EXPECT_EQ(jog->way_deg, -6.25);
  EXPECT_EQ(jog->rate_dps, 30.0);
  EXPECT_EQ(jog->leg, 12);
  for (const char* other : {"$J=G91X-6.250", "$J=G90X1F60(leg 1)", "$J=G91X1F60(leg 1) X2", "$$", ""})
    EXPECT_FALSE(grbl::parse_jog(other)) << other;
}

TEST(Grbl, ASettingHasANumberAndAValue) {
  const auto setting = grbl::parse_setting("$110=12000.000");
  ASSERT_TRUE(setting);
  EXPECT_EQ(setting->number, grbl::rate_setting);
  EXPECT_EQ(setting->value, 12000.0);
  EXPECT_TRUE(grbl::parse_setting("$110=500 (x max rate)"));
  for (const char* other : {"$110=", "$=1", "$$", "$N0=G91", "$110=1x", "$110=1e999", "110=1", ""})
    EXPECT_FALSE(grbl::parse_setting(other)) << other;
}

/// The maker's own examples.
TEST(Dynamixel, PacketsAreThoseOfTheDocument) {
  EXPECT_EQ(dynamixel::ping(1), (Bytes{0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x03, 0x00, 0x01, 0x19, 0x4E}));
  EXPECT_EQ(dynamixel::write(1, dynamixel::at::bus_watchdog, Bytes{10}),
            (Bytes{0xFF, 0xFF, 0xFD, 0x00, 0x01, 0x06, 0x00, 0x03, 0x62, 0x00, 0x0A, 0x4A, 0xE4}));
}

TEST(Dynamixel, AHeaderAmongTheParametersIsStuffedAndComesBack) {
  for (const Bytes& data : {Bytes{0xFF, 0xFF, 0xFD}, Bytes{0xFF, 0xFF, 0xFD, 0xFD},
                            Bytes{0xFF, 0xFF, 0xFF, 0xFD}, Bytes{0xFF, 0xFF, 0xFD, 0xFF, 0xFF, 0xFD, 0x00}}) {
    const Bytes whole = dynamixel::packet(3, dynamixel::Instruction::write, data);
    EXPECT_EQ(dynamixel::packet_size(whole), whole.size());
    const auto inside = whole.begin() + 4;
    const Bytes header{0xFF, 0xFF, 0xFD, 0x00};
    EXPECT_EQ(std::search(inside, whole.end(), header.begin(), header.end()), whole.end());
    ASSERT_TRUE(dynamixel::parse(whole));
    EXPECT_EQ(dynamixel::parse(whole)->parameters, data);
  }
}

TEST(Dynamixel, APacketIsMeasuredByItsHeaderAndReadIfItsSumFits) {
  Bytes bytes = dynamixel::write(1, dynamixel::at::goal_position, Bytes{0, 8, 0, 0});
  EXPECT_EQ(dynamixel::packet_size(bytes), bytes.size());
  EXPECT_EQ(dynamixel::packet_size(Bytes(bytes.begin(), bytes.begin() + 5)), 0U);
  EXPECT_FALSE(dynamixel::packet_size(Bytes{0xFF, 0xFE}));
  ASSERT_TRUE(dynamixel::parse(bytes));
  bytes[9] ^= 1;
  EXPECT_FALSE(dynamixel::parse(bytes));
  bytes[5] = bytes[6] = 0xFF;
  EXPECT_FALSE(dynamixel::packet_size(bytes)) << "longer than any of ours";
  EXPECT_FALSE(dynamixel::parse(dynamixel::packet(1, dynamixel::Instruction::status, {})))
      << "no error in it";
}

TEST(Dynamixel, NumbersOfFourBytesComeBack) {
  for (const std::int32_t value : {0, 1, -1, 2048, -40'000'000}) {
    Bytes bytes{7};
    dynamixel::put_i32(value, bytes);
    EXPECT_EQ(dynamixel::i32_at(bytes, 1), value);
  }
}

/// The maker's own examples.
TEST(Sts3215, PacketsAreThoseOfTheDocument) {
  EXPECT_EQ(sts3215::read(1, sts3215::at::present_position, 4),
            (Bytes{0xFF, 0xFF, 0x01, 0x04, 0x02, 0x38, 0x04, 0xBC}));
  const auto answer = sts3215::parse(Bytes{0xFF, 0xFF, 0x01, 0x06, 0x00, 0x00, 0x08, 0x3C, 0x80, 0x34});
  ASSERT_TRUE(answer);
  EXPECT_EQ(sts3215::signed_at(answer->parameters, 0), 2048);
  EXPECT_EQ(sts3215::signed_at(answer->parameters, 2), -60);
}

TEST(Sts3215, NumbersWithASignBitComeBack) {
  for (const std::int32_t value : {0, 1, -1, 2048, -30719, 32767}) {
    Bytes bytes;
    sts3215::put_signed(value, bytes);
    EXPECT_EQ(sts3215::signed_at(bytes, 0), value);
  }
}

/// Their packets look the same, and adapters send back what was sent.
TEST(Sts3215, NoInstructionIsTakenForAnAnswer) {
  for (const Bytes& sent :
       {sts3215::ping(sts3215::every_id), sts3215::note(515), sts3215::write(1, sts3215::at::lock, Bytes{0}),
        sts3215::read(1, sts3215::telemetry_begin, sts3215::telemetry_bytes),
        sts3215::write(1, sts3215::at::goal_position, Bytes(2)),
        sts3215::write(1, sts3215::at::least_angle, Bytes(4)),
        sts3215::write(1, sts3215::at::acceleration, Bytes(7))}) {
    ASSERT_TRUE(sts3215::parse(sent));
    EXPECT_FALSE(sts3215::is_answer(*sts3215::parse(sent))) << sent.size();
  }
  EXPECT_TRUE(sts3215::is_answer({1, 0, {}}));
  EXPECT_TRUE(sts3215::is_answer({1, 1, Bytes(sts3215::telemetry_bytes)}));
}

TEST(Grbl, NotesAreThoseOfTheDocument) {
  EXPECT_EQ(grbl::parse_power_note("(armed)"), true);
  EXPECT_EQ(grbl::parse_power_note("(disarmed)"), false);
  EXPECT_FALSE(grbl::parse_power_note("$X"));
  EXPECT_EQ(grbl::settings_request(), (Bytes{'$', '$', '\n'}));
  EXPECT_EQ(grbl::unlock(), (Bytes{'$', 'X', '\n'}));
  EXPECT_EQ(grbl::power_note(true).back(), '\n');
}

}  // namespace
}  // namespace thermorig::test::bus_servo_words
