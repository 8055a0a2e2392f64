// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <variant>
#include <vector>

#include "support/at_s.h"
#include "thermorig/sensors/wire/servo_messages.h"
#include "thermorig/simulation/virtual_rig.h"

// The rig with the real firmware in it, driven over the servo link as a host does.

namespace thermorig::simulation {
namespace {

/// Writes the commands that are due, refreshes every 40 ms, and keeps what the servo answers.
class Driver {
 public:
  explicit Driver(const VirtualRigConfig& config)
      : profile_(config.profile), rig_(config, make_host_firmware()) {
    rig_.keep_truth(true);
    run_to(0.2);
    send(wire::hello_bytes(1));
    run_to(0.3);
    send(wire::configure_bytes(2, profile_.servo));
    run_to(0.4);
    send(wire::arm_bytes(3, 0.0));
    run_to(1.4);
  }

  void send(const std::vector<std::uint8_t>& bytes) { rig_.send(Device::servo, bytes, now_); }

  void run_to(double seconds, bool refreshing = true) {
    while (now_ < at_s(seconds)) {
      now_ += from_s(0.020);
      if (refreshing && ++steps_ % 2 == 0) send(wire::refresh_bytes());
      for (const Chunk& chunk : rig_.advance(now_))
        if (chunk.device == Device::servo) scanner_.push(chunk.bytes, messages);
    }
  }

  std::vector<ServoState> states() const {
    std::vector<ServoState> result;
    for (const auto& message : messages)
      if (const auto* state = std::get_if<ServoState>(&message.body)) result.push_back(*state);
    return result;
  }

  const VirtualRig& rig() const { return rig_; }
  const wire::Counters& counters() const { return scanner_.counters(); }
  std::vector<wire::ServoMessage> messages;

 private:
  RigProfile profile_;
  VirtualRig rig_;
  wire::ServoScanner scanner_;
  HostTime now_ = at_s(0.0);
  int steps_ = 0;
};

double mean_rate_dps(const VirtualRig& rig, std::size_t from_ms, std::size_t to_ms) {
  const auto& shaft = rig.shaft();
  return (shaft[to_ms].angle_deg - shaft[from_ms].angle_deg) / (1e-3 * static_cast<double>(to_ms - from_ms));
}

TEST(DrivenRig, TurnsTheShaftAtTheCommandedSpeedAndSaysSo) {
  Driver driver(default_rig(5, "dining"));
  driver.send(wire::run_bytes(
      4, {.leg = 1, .turn_back = true, .rate_dps = 150.0, .acceleration_dps2 = 2000.0, .duration_s = 4.0}));
  driver.run_to(5.0);
  EXPECT_NEAR(mean_rate_dps(driver.rig(), 2500, 4500), 150.0, 6.0);
  EXPECT_NEAR(driver.states().back().rate_dps, 150.0, 0.1);
  driver.run_to(7.0);
  EXPECT_NEAR(mean_rate_dps(driver.rig(), 6500, 6900), 0.0, 0.5);
  EXPECT_EQ(driver.counters().bytes_skipped + driver.counters().bytes_in_damaged, 0U);
  EXPECT_EQ(driver.counters().lost, 0U);
  EXPECT_NEAR(static_cast<double>(driver.states().size()), 680.0, 20.0);  // 100 a second since hello
}

TEST(DrivenRig, TurnsBackBeforeTheEndOfAShortTravel) {
  auto config = default_rig(5, "dining");
  config.profile.servo.travel_deg = 270.0;
  Driver driver(config);
  driver.send(wire::run_bytes(
      4, {.leg = 1, .turn_back = true, .rate_dps = 200.0, .acceleration_dps2 = 2000.0, .duration_s = 6.0}));
  driver.run_to(6.0);
  double furthest_deg = 0.0;
  bool backward = false;
  for (const TruthSample& sample : driver.rig().shaft()) {
    furthest_deg = std::max(furthest_deg, std::abs(sample.angle_deg));
    backward = backward || sample.rate_dps < -150.0;
  }
  EXPECT_LT(furthest_deg, 142.0);
  EXPECT_TRUE(backward);
}

TEST(DrivenRig, StopsTheShaftWithin300MillisecondsOfTheLastByte) {
  Driver driver(default_rig(6, "dining"));
  driver.send(wire::run_bytes(
      4, {.leg = 1, .turn_back = true, .rate_dps = 200.0, .acceleration_dps2 = 2000.0, .duration_s = 20.0}));
  driver.run_to(4.0);
  driver.run_to(5.0, false);
  const auto& shaft = driver.rig().shaft();
  EXPECT_GT(std::abs(shaft[3990].rate_dps), 100.0);
  for (std::size_t ms = 4310; ms < 4900; ++ms) ASSERT_LT(std::abs(shaft[ms].rate_dps), 1.0) << ms;
}

TEST(DrivenRig, PutsOutThePulsesThatTelemetryReports) {
  Driver driver(default_rig(7, "dining"));
  driver.send(wire::go_to_bytes(4, {.angle_deg = 300.0, .rate_dps = 100.0, .acceleration_dps2 = 1000.0}));
  driver.run_to(6.0);
  ASSERT_FALSE(driver.rig().pulses().empty());
  EXPECT_NEAR(driver.rig().pulses().back().width_us, driver.states().back().pulse_us, 0.01);
  EXPECT_NEAR(driver.rig().shaft().back().angle_deg, 300.0, 12.0);
}

}  // namespace
}  // namespace thermorig::simulation
