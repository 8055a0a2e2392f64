// SPDX-License-Identifier: MIT
// Times of the second pass against what the simulated rig did. A constant of each device is left out: no
// arrival can tell it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "scripted_bytes.h"
#include "virtual_sweep.h"

namespace thermorig::pipeline {
namespace {

struct Recorded {
  VirtualSweep sweep;
  Fits fits;
  Result result;
};

Recorded record(const simulation::VirtualRigConfig& config, double duration_s) {
  Recorded recorded;
  std::vector<SweepLeg> legs;
  for (double begin_s = 2.0; begin_s + 7.0 <= duration_s; begin_s += 7.0)
    legs.push_back({begin_s, 6.0, legs.size() % 2 == 0 ? 100.0 : -60.0});
  recorded.sweep = drive(config, legs, duration_s);
  recorded.fits = first_pass(config.profile, recorded.sweep.chunks, recorded.sweep.sent);
  recorded.result = run(config.profile, recorded.sweep.chunks, recorded.fits, recorded.sweep.sent);
  return recorded;
}

double quantile(std::vector<double> values, double share) {
  const auto place = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + place, values.end());
  return values[static_cast<std::size_t>(place)];
}

/// Stamp minus truth of each message that came; `constant_s` is what they are off by in general. What was
/// lost is passed over by the nearest truth.
template <typename Message>
std::vector<double> differences_s(const std::vector<Message>& messages,
                                  const std::vector<simulation::SentMessage>& sent, double constant_s) {
  std::vector<double> differences;
  auto truth = sent.begin();
  for (const Message& message : messages) {
    const auto difference = [&](auto candidate) {
      return to_s(message.stamp.time - candidate->exposure_end) - constant_s;
    };
    while (truth + 1 != sent.end() && std::abs(difference(truth + 1)) < std::abs(difference(truth))) ++truth;
    differences.push_back(difference(truth));
  }
  return differences;
}

/// How far each stamp is from the truth, the median left out.
template <typename Message>
std::vector<double> errors_s(const std::vector<Message>& messages,
                             const std::vector<simulation::SentMessage>& sent) {
  const double constant_s = quantile(differences_s(messages, sent, 0.0), 0.5);
  std::vector<double> errors = differences_s(messages, sent, constant_s);
  for (double& error : errors) error = std::abs(error);
  return errors;
}

class TimesByHost : public testing::TestWithParam<bool> {};  // a loaded host?

TEST_P(TimesByHost, AreNearTheTruthWhateverTheHostDoes) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    auto config = simulation::default_rig(seed, "garden");
    for (auto& link : config.links.values) link.loaded_host = GetParam();
    const Recorded recorded = record(config, 40.0);
    const auto& streams = recorded.result.streams;
    EXPECT_LT(quantile(errors_s(streams.frames, recorded.sweep.frames), 0.99), 0.0006) << seed;
    EXPECT_LT(quantile(errors_s(streams.gyro, recorded.sweep.gyro), 0.99), 0.0012) << seed;
    for (const TimedFrame& frame : streams.frames) {
      EXPECT_EQ(frame.missing_before, 0U);
      EXPECT_FALSE(frame.late);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Hosts, TimesByHost, testing::Bool(), [](const testing::TestParamInfo<bool>& loaded) {
  return std::string(loaded.param ? "Loaded" : "Idle");
});

TEST(FinalTimes, AnOutageOfTheCameraIsAGapAndNothingIsSmeared) {
  auto config = simulation::default_rig(5, "garden");
  config.outages = {{Device::camera, HostTime(from_s(20.0)), HostTime(from_s(50.0))}};
  const Recorded recorded = record(config, 75.0);
  const auto& frames = recorded.result.streams.frames;
  const auto after = std::find_if(frames.begin(), frames.end(),
                                  [](const TimedFrame& frame) { return frame.missing_before > 0; });
  ASSERT_NE(after, frames.end());
  const double period_s = *recorded.fits.frame_period_s;
  EXPECT_NEAR(after->missing_before * period_s, 30.0, 2 * period_s);
  EXPECT_LT(quantile(errors_s(frames, recorded.sweep.frames), 1.0), 0.0012);
  const auto& gaps = recorded.fits.sync->clock[Device::camera].gaps;
  ASSERT_EQ(gaps.size(), 1U);
  EXPECT_EQ(gaps[0].missing, after->missing_before);
}

/// A rig that is the same but for one frame, in the middle, that never reaches the host.
simulation::VirtualRigConfig without_one_frame(simulation::VirtualRigConfig config, double duration_s,
                                               std::size_t& lost) {
  const auto sent = drive(config, {{2.0, 4.0, 60.0}}, duration_s).frames;
  lost = sent.size() / 2;
  const double frame_s = 0.036;  // on the wire, and a little
  config.outages = {{Device::camera, sent[lost].sent - from_s(0.001), sent[lost].sent + from_s(frame_s)}};
  return config;
}

TEST_P(TimesByHost, AFrameThatNeverCameMovesNoOther) {
  for (const double duration_s : {8.0, 20.0}) {
    auto config = simulation::default_rig(3, "garden");
    config.links[Device::camera].loaded_host = GetParam();
    config.camera_latency_s = config.profile.camera.link.latency_s;
    config.profile.camera.link.latency_uncertainty_s = 1e-5;
    std::size_t lost = 0;
    config = without_one_frame(config, duration_s, lost);
    const VirtualSweep sweep = drive(config, {{2.0, 4.0, 60.0}}, duration_s);
    const Fits fits = first_pass(config.profile, sweep.chunks);
    const Streams live = run(config.profile, sweep.chunks).streams;
    const auto& times = fits.times[Device::camera];
    ASSERT_GT(times.size(), lost + 10);
    EXPECT_EQ(fits.gaps[lost].missing, 1);
    for (std::size_t i = 0; i < times.size(); ++i) {
      const HostTime truth = sweep.frames[i < lost ? i : i + 1].exposure_end;
      EXPECT_NEAR(to_s(times[i].time - truth), 0.0, 0.0012) << duration_s << " s, frame " << i;
      if (i < lost) continue;
      EXPECT_NEAR(to_s(live.frames[i].stamp.time - truth), 0.0, 0.003) << "live, frame " << i;
    }
  }
}

TEST(FinalTimes, AreTheFitsTimesInOrder) {
  const Recorded recorded = record(simulation::default_rig(6, "garden"), 12.0);
  const auto& times = recorded.fits.times;
  const auto& streams = recorded.result.streams;
  ASSERT_EQ(times[Device::camera].size(), streams.frames.size());
  ASSERT_EQ(times[Device::gyro].size(), streams.gyro.size());
  ASSERT_EQ(times[Device::servo].size(), streams.servo.size());
  for (std::size_t i = 0; i < streams.gyro.size(); ++i) {
    EXPECT_EQ(streams.gyro[i].stamp.time, times[Device::gyro][i].time);
    EXPECT_EQ(streams.gyro[i].stamp.later_s, times[Device::gyro][i].later_s);
  }
  EXPECT_EQ(recorded.fits.sync->clock[Device::camera].method, "one-way");
  EXPECT_EQ(recorded.fits.sync->clock[Device::servo].method, "two-way");
}

TEST(FinalTimes, TheServosClockIsOneWayWhereNoPingWasSent) {
  auto sweep = drive(simulation::default_rig(6, "garden"), {{2.0, 6.0, 100.0}}, 10.0);
  const Fits fits = first_pass(sweep.config.profile, sweep.chunks);
  EXPECT_EQ(fits.sync->clock[Device::servo].method, "one-way");
  EXPECT_FALSE(fits.times[Device::servo].empty());
}

TEST(FinalTimes, ServoStampsAreBoundedLiveOnceAPingWasAnswered) {
  const auto sweep = drive(simulation::default_rig(6, "garden"), {{2.0, 6.0, 100.0}}, 10.0);
  const Result live = run(sweep.config.profile, sweep.chunks, {}, sweep.sent);
  ASSERT_FALSE(live.streams.pongs.empty());
  const HostTime answered = live.streams.pongs[2].arrival;
  for (const TimedServo& state : live.streams.servo) {
    if (state.stamp.arrival <= answered) continue;
    EXPECT_GT(state.stamp.earlier_s + state.stamp.later_s, 0.0F);
    EXPECT_LT(state.stamp.time, state.stamp.arrival);
  }
  EXPECT_TRUE(live.streams.servo_epochs.empty());
}

}  // namespace
}  // namespace thermorig::pipeline
