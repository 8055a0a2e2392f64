// SPDX-License-Identifier: MIT
// Another process reads the gyro's port as well: what it gets, this one never sees. No gyro numbers its
// samples, so the loss shows in its steady rate alone, or in its own time - and what only comes late must not
// look like it.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>

#include "thermorig/fit/fit.h"
#include "thermorig/pipeline/pipeline.h"
#include "thermorig/simulation/virtual_rig.h"

namespace thermorig::pipeline {
namespace {

using simulation::GyroGrade;
using simulation::UsbLink;

constexpr double duration_s = 16.0;

struct GyroKind {
  const char* name;
  const char* protocol;
  bool sends_time;
  double rate_hz;
  GyroGrade grade;
};

constexpr GyroKind gyro_kinds[] = {
    {"WitMotion at 200 Hz", "witmotion", false, 200.0, GyroGrade::typical},
    {"WitMotion at 100 Hz", "witmotion", false, 100.0, GyroGrade::calibrated},
    {"text at 200 Hz", "text", false, 200.0, GyroGrade::mpu6050_raw},
    {"text at 50 Hz", "text", false, 50.0, GyroGrade::typical},
    {"text with its time at 100 Hz", "text", true, 100.0, GyroGrade::mpu6050_raw},
    {"MAVLink at 100 Hz", "mavlink", true, 100.0, GyroGrade::typical}};

constexpr simulation::LinkConfig gyro_links[] = {{.kind = UsbLink::ftdi, .latency_timer_s = 0.016},
                                                 {.kind = UsbLink::ftdi, .latency_timer_s = 0.001},
                                                 {.kind = UsbLink::ch340},
                                                 {.kind = UsbLink::cdc}};

simulation::VirtualRigConfig rig_with(const GyroKind& kind, simulation::LinkConfig link, bool loaded_host,
                                      std::uint64_t seed) {
  simulation::VirtualRigConfig config = simulation::default_rig(seed, "laboratory");
  GyroProfile& gyro = config.profile.gyro;
  gyro.protocol = kind.protocol;
  gyro.output_rate_hz = kind.rate_hz;
  if (link.kind == UsbLink::cdc) gyro.link.baud = 0;
  if (kind.sends_time)
    gyro.text = {.prefix = "", .rate = {1, 2, 3}, .scale_dps = 1.0, .time = 0, .time_unit_s = 1e-3};
  config.gyro_grade = kind.grade;
  link.loaded_host = loaded_host;
  config.links[Device::gyro] = link;
  return config;
}

struct HeardGyro {
  std::uint64_t samples = 0;
  std::uint64_t lost_live = 0;
  std::vector<ClockGap> gaps;

  std::uint64_t lost() const {
    std::uint64_t sum = 0;
    for (const ClockGap& gap : gaps) sum += gap.missing;
    return sum;
  }
};

/// What arrives of a gyro at rest, but for the chunks that are stolen.
HeardGyro hear_gyro(const simulation::VirtualRigConfig& config, double until_s,
                    const std::function<bool(HostTime)>& is_stolen) {
  simulation::VirtualRig rig(config, simulation::make_host_firmware());
  RawRecording raw;
  raw.header.profile = config.profile;
  Pipeline pipeline(config.profile);
  for (const Chunk& chunk : rig.advance(HostTime(from_s(until_s)))) {
    if (chunk.device != Device::gyro || is_stolen(chunk.arrived)) continue;
    raw.received[chunk.device].append(chunk.bytes, chunk.arrived);
    pipeline.feed(chunk.device, chunk.bytes, chunk.arrived);
  }
  pipeline.finish();
  HeardGyro heard{.samples = pipeline.counters(Device::gyro).messages,
                  .lost_live = pipeline.counters(Device::gyro).lost,
                  .gaps = {}};
  heard.gaps = fit::fit_recording(raw, pipeline.take_streams()).sync->clock[Device::gyro].gaps;
  return heard;
}

bool nothing_is_stolen(HostTime) {
  return false;
}

/// For 4 s somebody else gets about every twentieth chunk.
std::function<bool(HostTime)> thief(std::uint64_t seed) {
  return [random = std::mt19937(static_cast<std::uint32_t>(seed))](HostTime arrived) mutable {
    const double time_s = to_s(arrived.time_since_epoch());
    return time_s > 6.0 && time_s < 10.0 && random() % 1000 < 44;
  };
}

TEST(StolenBytes, CountAsLostSamplesOfEveryKindOfGyro) {
  std::uint64_t seed = 0;
  for (const GyroKind& kind : gyro_kinds)
    for (const simulation::LinkConfig& link : gyro_links) {
      const auto config = rig_with(kind, link, false, ++seed);
      const HeardGyro heard = hear_gyro(config, duration_s, thief(seed));
      const HeardGyro whole = hear_gyro(config, duration_s, nothing_is_stolen);
      EXPECT_EQ(whole.lost() + whole.lost_live, 0U) << kind.name << ", seed " << seed;
      const auto stolen = static_cast<double>(whole.samples - heard.samples);
      ASSERT_GT(stolen, 0.0) << kind.name;
      EXPECT_NEAR(static_cast<double>(heard.lost()), stolen, std::max(2.0, 0.1 * stolen))
          << kind.name << ", seed " << seed;
      // Torn lines may read as a sample of a wrong time.
      EXPECT_NEAR(static_cast<double>(heard.lost_live), stolen, kind.sends_time ? 0.2 * stolen : 1.0)
          << kind.name << ", seed " << seed;
    }
}

TEST(StolenBytes, AreNotSeenWhereReadsOnlyComeLate) {
  std::uint64_t seed = 100;
  for (const GyroKind& kind : gyro_kinds)
    for (const simulation::LinkConfig& link : gyro_links) {
      // On an idle computer nothing is late: StolenBytes.CountAsLostSamplesOfEveryKindOfGyro looks at that.
      const HeardGyro heard = hear_gyro(rig_with(kind, link, true, ++seed), duration_s, nothing_is_stolen);
      EXPECT_EQ(heard.lost(), 0U) << kind.name << ", seed " << seed;
      EXPECT_EQ(heard.lost_live, 0U) << kind.name << ", seed " << seed;
    }
}

TEST(StolenBytes, AreMissedWhereTheyWereStolen) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const auto config = rig_with(gyro_kinds[0], gyro_links[0], false, seed);
    std::vector<double> thefts_s;
    const HeardGyro heard =
        hear_gyro(config, duration_s, [&, steals = thief(seed)](HostTime arrived) mutable {
          const bool is_stolen = steals(arrived);
          if (is_stolen) thefts_s.push_back(to_s(arrived.time_since_epoch()));
          return is_stolen;
        });
    constexpr double near_s = 0.1;  // less than a frame
    for (const double theft_s : thefts_s)
      EXPECT_TRUE(std::any_of(heard.gaps.begin(), heard.gaps.end(),
                              [&](const ClockGap& gap) {
                                return to_s(gap.begin.time_since_epoch()) - near_s < theft_s &&
                                       theft_s < to_s(gap.end.time_since_epoch()) + near_s;
                              }))
          << "seed " << seed << ", at " << theft_s << " s";
  }
}

}  // namespace
}  // namespace thermorig::pipeline
