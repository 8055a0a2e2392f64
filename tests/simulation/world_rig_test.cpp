// SPDX-License-Identifier: MIT
// Worlds as a whole rig has them: every knob reaches its device, and the truth stays true.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "scripted_firmware.h"
#include "simulation/world_knobs.h"
#include "support/at_s.h"
#include "thermorig/simulation/virtual_rig.h"

namespace thermorig::simulation {
namespace {

/// Rest, a sweep, and a jump back as fast as the servo can.
double driven_angle_deg(double time_s) {
  return time_s < 2.0 ? 0.0 : time_s < 5.0 ? 120.0 * (time_s - 2.0) : -500.0;
}

std::unique_ptr<VirtualRig> rig_in(const std::string& world, std::uint64_t seed = 1) {
  auto config = default_rig(seed, "kitchen");
  config.world = world_named(world, seed);
  auto rig = std::make_unique<VirtualRig>(config, std::make_unique<ScriptedFirmware>(driven_angle_deg));
  rig->keep_truth(true);
  return rig;
}

struct Sent {
  HostTime arrived;
  std::vector<std::uint8_t> bytes;
  bool operator==(const Sent&) const = default;
};

/// All that arrives of a rig in 9 s, with an answer of the servo's each second.
std::vector<Sent> sent_by(VirtualRig& rig, double step_s = 1.0) {
  std::vector<Sent> sent;
  for (int step = 1; step <= static_cast<int>(std::lround(9.0 / step_s)); ++step) {
    const double time_s = step * step_s;
    for (Chunk& chunk : rig.advance(at_s(time_s))) sent.push_back({chunk.arrived, std::move(chunk.bytes)});
    if (std::abs(time_s - std::round(time_s)) < 1e-9)
      rig.send(Device::servo, std::vector<std::uint8_t>{1, 2, 3}, at_s(time_s));
  }
  return sent;
}

/// What a knob needs beside it to do anything.
std::string needed_by(const Knob& knob) {
  const std::map<std::string_view, std::string> needs{
      {"servo.ripple_period_deg", ",servo.ripple=0.03"},  {"clock.wave_period_s", ",clock.wave_ppm=40"},
      {"links.stall_interval_s", ",links.stall_ms=200"},  {"gyro.self_heating_s", ",gyro.self_heating_k=10"},
      {"gyro.bias_per_k_dps", ",gyro.self_heating_k=10"}, {"gyro.scale_per_k", ",gyro.self_heating_k=10"},
      {"scene.distance_m", ",camera.lever_arm_m=0.05"}};
  const auto need = needs.find(knob.name);
  return need == needs.end() ? "" : need->second;
}

TEST(WorldKnobs, EachChangeWhatTheRigSends) {
  for (const Knob& knob : world_knobs()) {
    if (knob.name.starts_with("encoder.")) continue;  // this firmware reads none: see as5600_test.cpp
    const bool is_low_further = knob.honest() - knob.low > knob.high - knob.honest();
    World world = world_named("honest" + needed_by(knob), 5);
    const auto without = sent_by(*rig_in(text_of(world)));
    knob.of(world) = is_low_further ? knob.low : knob.high;
    EXPECT_FALSE(sent_by(*rig_in(text_of(world))) == without) << knob.name;
  }
}

class WorldOfSeed : public testing::TestWithParam<std::uint64_t> {};

TEST_P(WorldOfSeed, RepeatsItselfHoweverOftenTheRigIsAdvanced) {
  const auto at_once = sent_by(*rig_in("hard", GetParam()));
  EXPECT_TRUE(sent_by(*rig_in("hard", GetParam())) == at_once);
  EXPECT_TRUE(sent_by(*rig_in("hard", GetParam()), 0.002) == at_once);
}

/// Of the shaft, between its samples of a millisecond.
double angle_at(const std::vector<TruthSample>& shaft, HostTime time) {
  const auto after = std::find_if(shaft.begin(), shaft.end(),
                                  [&](const TruthSample& sample) { return sample.time >= time; });
  if (after == shaft.begin() || after == shaft.end()) return NAN;
  const auto before = after - 1;
  const double part = to_s(time - before->time) / to_s(after->time - before->time);
  return std::lerp(before->angle_deg, after->angle_deg, part);
}

TEST_P(WorldOfSeed, SaysTheMeanRateOverEachExposure) {
  const auto rig = rig_in("hard", GetParam());
  sent_by(*rig);
  int compared = 0;
  for (const auto* messages : {&rig->sent_frames(), &rig->sent_gyro()})
    for (const SentMessage& message : *messages) {
      const double turned_deg =
          angle_at(rig->shaft(), message.exposure_end) - angle_at(rig->shaft(), message.exposure_begin);
      if (std::isnan(turned_deg)) continue;
      const double seconds = to_s(message.exposure_end - message.exposure_begin);
      const double of_the_hosts_clock_deg = 5e-4 * std::abs(turned_deg);  // rates are per true second
      EXPECT_NEAR(turned_deg, message.mean_rate_dps * seconds, 0.03 + of_the_hosts_clock_deg)
          << message.index;
      EXPECT_GT(message.sent, message.exposure_end);
      ++compared;
    }
  EXPECT_GT(compared, 1700);
}

INSTANTIATE_TEST_SUITE_P(Seeds, WorldOfSeed, testing::Range<std::uint64_t>(1, 4));

}  // namespace
}  // namespace thermorig::simulation
