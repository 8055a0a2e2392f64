// SPDX-License-Identifier: MIT
// What a recording says of its gyro and its servo, against a simulated rig that knows.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "labels/scripted_rig.h"
#include "simulation/servo_side.h"
#include "thermorig/core/validity.h"
#include "thermorig/fit/shaft/gyro_errors.h"
#include "thermorig/fit/shaft/servo_response.h"
#include "thermorig/pipeline/labels/exposure.h"
#include "thermorig/pipeline/pipeline.h"
#include "thermorig/sensors/wire/servo_messages.h"
#include "thermorig/simulation/virtual_rig.h"

namespace thermorig::fit {

using namespace labels;

namespace {

constexpr double step_s = 0.01;

/// A recording whose clocks are the true ones: what labels make of it is their own doing.
struct TrueTimes {
  RigProfile profile;
  std::vector<TimedFrame> frames;
  std::vector<TimedGyro> gyro;
  std::vector<TimedServo> servo;
  std::vector<simulation::SentMessage> sent_frames;
  std::vector<simulation::SentMessage> sent_gyro;
  std::vector<simulation::TruthSample> shaft;

  double gyro_scale() const {  // by least squares, gyro over truth
    double x = 0, y = 0, xx = 0, xy = 0;
    const auto n = static_cast<double>(gyro.size());
    for (std::size_t i = 0; i < gyro.size(); ++i) {
      const double rate = sent_gyro[i].mean_rate_dps, measured = gyro[i].rate_dps;
      x += rate;
      y += measured;
      xx += rate * rate;
      xy += rate * measured;
    }
    return (xy - x * y / n) / (xx - x * x / n);
  }
};

/// 4 s legs at `rates_dps`, there and back over the travel, with rests of 1 s between them and of 5 s at both
/// ends.
TrueTimes record(const simulation::VirtualRigConfig& config, const std::vector<double>& rates_dps) {
  simulation::VirtualRig rig(config, simulation::make_host_firmware());
  rig.keep_truth(true);
  const ServoProfile& servo = config.profile.servo;
  std::vector<std::pair<double, std::vector<std::uint8_t>>> script{
      {0.3, wire::hello_bytes(0)}, {0.4, wire::configure_bytes(1, servo)}, {0.5, wire::arm_bytes(2, 0.0)}};
  for (std::size_t i = 0; i < rates_dps.size(); ++i)
    script.push_back(
        {5.0 + 5.0 * static_cast<double>(i),
         wire::run_bytes(static_cast<std::uint8_t>(3 + i), {.leg = static_cast<std::uint16_t>(i + 1),
                                                            .turn_back = true,
                                                            .rate_dps = rates_dps[i],
                                                            .acceleration_dps2 = servo.acceleration_dps2,
                                                            .duration_s = 4.0})});
  pipeline::Pipeline decoder(config.profile);
  auto next = script.begin();
  for (int step = 0; step * step_s < 9.0 + 5.0 * static_cast<double>(rates_dps.size()); ++step) {
    const HostTime now(from_s(step * step_s));
    for (; next != script.end() && next->first <= step * step_s; ++next)
      rig.send(Device::servo, next->second, now);
    if (step % 4 == 0) rig.send(Device::servo, wire::refresh_bytes(), now);
    for (const Chunk& chunk : rig.advance(now + from_s(step_s)))
      decoder.feed(chunk.device, chunk.bytes, chunk.arrived);
  }
  pipeline::Streams streams = decoder.take_streams();
  TrueTimes truth{config.profile,
                  std::move(streams.frames),
                  std::move(streams.gyro),
                  std::move(streams.servo),
                  rig.sent_frames(),
                  rig.sent_gyro(),
                  rig.shaft()};
  const double sent_period_s =
      to_s(truth.sent_frames[80].exposure_end - truth.sent_frames[0].exposure_end) / 80.0;
  ExposureRule rule(sent_period_s, config.half_fresh ? CameraMode::half_fresh : CameraMode::full_fresh);
  for (std::size_t i = 0; i < truth.frames.size(); ++i) {
    TimedFrame& frame = truth.frames[i];
    frame.stamp = {.time = truth.sent_frames[i].exposure_end, .uncertainty_s = 2e-4F};
    frame.missing_before = 0;
    frame.late = false;
    rule.apply(frame);
  }
  for (std::size_t i = 0; i < truth.gyro.size(); ++i) {
    const simulation::SentMessage& sent = truth.sent_gyro[i];
    truth.gyro[i].stamp = {.time = sent.exposure_begin + (sent.exposure_end - sent.exposure_begin) / 2,
                           .uncertainty_s = 2e-4F};
  }
  simulation::McuClock clock(config.seed);
  for (TimedServo& message : truth.servo)
    message.stamp = {.time = HostTime(HostDuration(clock.rig_ns_at(double(message.mcu_time_us)))),
                     .uncertainty_s = 5e-5F};
  return truth;
}

std::vector<LabelledSample> label(const TrueTimes& recording, const LabelConfig& config) {
  Labeller labeller(config);
  std::vector<LabelledSample> samples;
  std::size_t gyro = 0, servo = 0;
  for (const TimedFrame& frame : recording.frames) {
    const HostTime until = frame.exposure_end + from_s(0.02);
    for (; gyro < recording.gyro.size() && recording.gyro[gyro].stamp.time < until; ++gyro)
      labeller.add(recording.gyro[gyro]);
    for (; servo < recording.servo.size() && recording.servo[servo].stamp.time < until; ++servo)
      labeller.add(recording.servo[servo]);
    labeller.add(frame);
    for (const LabelledSample& sample : labeller.take(until)) samples.push_back(sample);
  }
  for (const LabelledSample& sample : labeller.finish()) samples.push_back(sample);
  return samples;
}

simulation::VirtualRigConfig rig_of(double travel_deg, double loop_hz, std::uint64_t seed) {
  auto config = simulation::default_rig(seed, "garden");
  config.profile.servo.travel_deg = travel_deg;
  config.servo_loop_hz = loop_hz;
  for (const Device device : all_devices) config.links[device].kind = simulation::UsbLink::cdc;
  return config;
}

const std::vector<double> speeds_dps{20, -35, 60, -100, 150, -200, 200, -150, 100, -60, 35, -20};

SyncReport fit(const TrueTimes& recording, const RigProfile& profile) {
  SyncReport sync;
  sync.gyro = fit_gyro_errors(recording.gyro, recording.servo, profile.gyro);
  sync.servo = fit_servo_response(recording.servo, recording.gyro, sync.gyro, profile.servo);
  return sync;
}

double shaft_deg(const TrueTimes& recording, HostTime time) {
  const double place = std::max(0.0, to_s(time - recording.shaft.front().time) / 0.001);
  const auto left = std::min(static_cast<std::size_t>(place), recording.shaft.size() - 2);
  return std::lerp(recording.shaft[left].angle_deg, recording.shaft[left + 1].angle_deg,
                   place - static_cast<double>(left));
}

/// The shaft's 20 ms means stay within max(1 deg/s, 2 %) of the commanded speed over the true exposure.
bool truly_steady(const TrueTimes& recording, const LabelledSample& sample) {
  const auto& sent = recording.sent_frames[sample.frame_index];
  const double commanded = sample.rate_commanded_dps, window_s = 0.02;
  for (HostTime time = sent.exposure_begin; time + from_s(window_s) <= sent.exposure_end;
       time += from_s(0.002)) {
    const double turned = shaft_deg(recording, time + from_s(window_s)) - shaft_deg(recording, time);
    if (!(std::abs(turned / window_s - commanded) <= std::max(1.0, 0.02 * std::abs(commanded)))) return false;
  }
  return sample.leg != 0;
}

struct Verdict {
  double rms_dps = 0.0;
  std::size_t valid = 0, beyond = 0, steady = 0, rejected = 0;
};
Verdict judge(const TrueTimes& recording, const std::vector<LabelledSample>& samples,
              float LabelledSample::*rate_dps = &LabelledSample::rate_shaft_dps,
              float LabelledSample::*uncertainty_dps = &LabelledSample::rate_shaft_uncertainty_dps) {
  Verdict verdict;
  for (const LabelledSample& sample : samples) {
    if (truly_steady(recording, sample)) {
      ++verdict.steady;
      if (!sample.valid) ++verdict.rejected;
    }
    if (!sample.valid) continue;
    const double error = sample.*rate_dps - recording.sent_frames[sample.frame_index].mean_rate_dps;
    ++verdict.valid;
    verdict.rms_dps += error * error;
    if (!(std::abs(error) <= 3.0 * sample.*uncertainty_dps)) ++verdict.beyond;
  }
  verdict.rms_dps = std::sqrt(verdict.rms_dps / static_cast<double>(verdict.valid));
  return verdict;
}

/// The rig's profile, the scale of its gyro in it.
RigProfile calibrated_profile(const TrueTimes& recording) {
  RigProfile profile = recording.profile;
  profile.gyro.scale = recording.gyro_scale();
  profile.gyro.scale_uncertainty = 0.002;
  profile.gyro.scale_measured_utc = "2024-01-01T00:00:00Z";
  return profile;
}

TEST(ServoResponse, IsThatOfTheSimulatedServo) {
  for (const auto& [travel_deg, loop_hz] : {std::pair{180.0, 12.0}, {270.0, 5.0}, {2160.0, 8.0}}) {
    const TrueTimes recording = record(rig_of(travel_deg, loop_hz, 11), speeds_dps);
    const ServoResponse response = fit(recording, recording.profile).servo;
    EXPECT_TRUE(response.fitted);
    EXPECT_NEAR(response.delay_s, 0.0, 0.003);  // the simulated one answers a pulse at once
    EXPECT_NEAR(response.loop_hz, loop_hz, 0.1 * loop_hz);
    EXPECT_LT(response.residual_dps, 0.5);
    EXPECT_GE(response.speeds.size(), 6U);
    EXPECT_FALSE(response.scale_calibrated);
    EXPECT_GT(response.scale.uncertainty, 0.01);  // neither gyro nor servo knows better
  }
}

/// What it says is commanded is then where the shaft is, until it turns as it was asked to.
TEST(ServoResponse, OfAServoThatSendsItsShaftsAngleTheDelayIsThatOfTheClocks) {
  TrueTimes recording = record(rig_of(2160.0, 8.0, 11), speeds_dps);
  std::vector<TimedServo> asked;
  constexpr std::size_t messages_apart = 2;  // 20 ms
  for (std::size_t i = messages_apart; i < recording.servo.size(); i += messages_apart) {
    TimedServo message = recording.servo[i];
    if (i % 150 > 142) continue;  // the host is busy for 0.08 s
    const HostTime before = recording.servo[i - messages_apart].stamp.time;
    const double angle_deg = shaft_deg(recording, message.stamp.time);
    const double rate_dps = (angle_deg - shaft_deg(recording, before)) / to_s(message.stamp.time - before);
    ServoState& state = message.state;
    const bool has_speed = std::abs(rate_dps - state.rate_dps) < 0.02 * std::abs(state.rate_dps);
    if (state.motion == ServoMotion::steady && !has_speed) state.motion = ServoMotion::ramping;
    if (state.motion != ServoMotion::steady) state.rate_dps = rate_dps;
    state.angle_deg = angle_deg;
    state.pulse_us = 0.0F;
    state.is_measured = true;
    asked.push_back(message);
  }
  recording.servo = std::move(asked);
  GyroErrors errors = fit_gyro_errors(recording.gyro, recording.servo, recording.profile.gyro);
  const ServoResponse response =
      fit_servo_response(recording.servo, recording.gyro, errors, recording.profile.servo, 0.125, {}, 0.12);
  EXPECT_TRUE(response.fitted);
  EXPECT_NEAR(response.delay_s, 0.0, 0.01);
  EXPECT_LT(response.residual_dps, 1.0) << "silences are bridged";
}

/// A servo by a gyro with a low-pass whose delay is known.
ServoResponse seen_through_low_pass(double loop_hz, double bandwidth_hz) {
  auto config = rig_of(2160.0, loop_hz, 11);
  config.world.gyro.bandwidth_hz = bandwidth_hz;
  const TrueTimes recording = record(config, speeds_dps);
  GyroErrors errors = fit_gyro_errors(recording.gyro, recording.servo, recording.profile.gyro);
  errors.filter_delay_s = {GyroProfile::second_order_delay / bandwidth_hz, 0.002};
  return fit_servo_response(recording.servo, recording.gyro, errors, recording.profile.servo);
}

/// The gyro rounds what begins and ends: it is not the servo that is slow.
TEST(ServoResponse, IsSeenThroughTheGyrosLowPass) {
  const ServoResponse response = seen_through_low_pass(8.0, 5.0);
  EXPECT_TRUE(response.fitted);
  EXPECT_NEAR(response.loop_hz, 8.0, 0.8);
  EXPECT_NEAR(response.delay_s, 0.0, 0.003);
}

/// Of a fast loop, whose shaft nearly steps from pulse to pulse, a slow gyro shows no step.
TEST(ServoResponse, IsAsUncertainAsWhatTheGyrosLowPassHidesOfIt) {
  const ServoResponse response = seen_through_low_pass(20.0, 10.0);
  ASSERT_EQ(response.speeds.size(), speeds_dps.size());
  for (const ServoResponse::AtSpeed& speed : response.speeds)
    EXPECT_GT(speed.spread_dps, 0.005 * std::abs(speed.rate_dps)) << speed.rate_dps;
}

TEST(ServoResponse, LabelsAfterCalibrationAreTheShaftsSpeed) {
  std::uint64_t seed = 21;
  for (const auto& [travel_deg, loop_hz] : {std::pair{180.0, 5.0}, {270.0, 15.0}, {2160.0, 8.0}}) {
    const TrueTimes recording = record(rig_of(travel_deg, loop_hz, seed++), speeds_dps);
    const RigProfile calibrated = calibrated_profile(recording);
    const SyncReport sync = fit(recording, calibrated);
    EXPECT_TRUE(sync.servo.scale_calibrated);
    LabelConfig config = label_config(calibrated, sync, false);
    config.latency_uncertainty_s = 2e-4;
    const Verdict verdict = judge(recording, label(recording, config));
    EXPECT_GT(verdict.valid, 150U);
    EXPECT_LT(verdict.rms_dps, 0.5) << travel_deg;
    EXPECT_LE(verdict.beyond, verdict.valid / 100);
    EXPECT_LE(verdict.rejected, verdict.steady / 20) << travel_deg;
  }
}

TEST(ServoResponse, CorrectedLabelsAreCloserToTheShaftThanTheCommandAndBothSayHowClose) {
  std::uint64_t seed = 41;
  for (const double travel_deg : {180.0, 270.0, 2160.0}) {
    const TrueTimes recording = record(rig_of(travel_deg, 8.0, seed++), speeds_dps);
    const RigProfile calibrated = calibrated_profile(recording);
    LabelConfig config = label_config(calibrated, fit(recording, calibrated), false);
    config.latency_uncertainty_s = 2e-4;
    const auto samples = label(recording, config);
    const Verdict commanded = judge(recording, samples, &LabelledSample::rate_commanded_dps,
                                    &LabelledSample::rate_commanded_uncertainty_dps);
    const Verdict corrected = judge(recording, samples, &LabelledSample::rate_corrected_dps,
                                    &LabelledSample::rate_corrected_uncertainty_dps);
    EXPECT_LT(corrected.rms_dps, 0.8 * commanded.rms_dps) << travel_deg;
    EXPECT_LE(commanded.beyond, commanded.valid / 100) << travel_deg;
    EXPECT_LE(corrected.beyond, corrected.valid / 100) << travel_deg;
  }
}

TEST(ServoResponse, ASpeedThatIsNotReachedIsNamedAndLeftOutOfTheFit) {
  auto config = rig_of(2160.0, 8.0, 35);
  const double scale = fit(record(config, speeds_dps), config.profile).servo.gyro_ratio.value;
  config.world.servo.top_speed_dps = 180.0;
  const TrueTimes recording = record(config, speeds_dps);
  const SyncReport sync = fit(recording, recording.profile);
  for (const ServoResponse::AtSpeed& speed : sync.servo.speeds)
    EXPECT_EQ(speed.contradicts, std::abs(speed.rate_dps) > 180.0) << speed.rate_dps;
  EXPECT_LT(sync.servo.speeds.back().reached_dps, 190.0);
  EXPECT_NEAR(sync.servo.gyro_ratio.value, scale, 0.002);  // as if it had never been commanded
  std::size_t at_200 = 0;
  for (const LabelledSample& sample : label(recording, label_config(recording.profile, sync, false))) {
    if (!(std::abs(sample.rate_commanded_dps) > 199.0)) continue;
    EXPECT_FALSE(sample.valid);
    ++at_200;
  }
  EXPECT_GT(at_200, 40U);
}

/// What runs straight from 0 at the beginning to `end_dps` at the end.
double drift_at(const TrueTimes& recording, HostTime time, double end_dps) {
  const HostTime begin = recording.gyro.front().stamp.time, end = recording.gyro.back().stamp.time;
  return end_dps * to_s(time - begin) / to_s(end - begin);
}

/// There and back, three times over.
const std::vector<double> for_three_minutes = [] {
  std::vector<double> rates;
  for (int i = 0; i < 3; ++i) rates.insert(rates.end(), speeds_dps.begin(), speeds_dps.end());
  return rates;
}();

TEST(BiasCourse, FollowsABiasThatDrifts) {
  TrueTimes recording = record(rig_of(2160.0, 8.0, 36), for_three_minutes);
  const double before_dps = *fit(recording, recording.profile).gyro.bias_before_dps;
  constexpr double drift_dps = 3.0;
  for (TimedGyro& sample : recording.gyro)
    sample.rate_dps += static_cast<float>(drift_at(recording, sample.stamp.time, drift_dps));
  const GyroErrors errors = fit(recording, recording.profile).gyro;
  ASSERT_GE(errors.bias_course.size(), 4U);
  const double begin_s = 10.0, end_s = 5.0 * static_cast<double>(for_three_minutes.size());
  for (double t = begin_s; t < end_s; t += 10.0) {
    const HostTime time = recording.gyro.front().stamp.time + from_s(t);
    EXPECT_NEAR(bias_dps_at(errors, time), before_dps + drift_at(recording, time, drift_dps), 0.3) << t;
  }
}

TEST(BiasCourse, IsNoneWhereTheBiasStays) {
  const TrueTimes recording = record(rig_of(2160.0, 8.0, 36), for_three_minutes);
  const GyroErrors errors = fit(recording, recording.profile).gyro;
  EXPECT_TRUE(errors.bias_course.empty());
  EXPECT_EQ(bias_dps_at(errors, recording.gyro.back().stamp.time), errors.bias_dps->value);
}

/// What a ripple's sizes are, forward and backward.
std::pair<double, double> sizes(const ServoResponse::Ripple& ripple) {
  return {std::hypot(ripple.forward_cosine, ripple.forward_sine),
          std::hypot(ripple.backward_cosine, ripple.backward_sine)};
}

TEST(Ripples, OfAWheelOffItsCentreAreFoundAndFollowedByTheLabels) {
  auto config = rig_of(2160.0, 8.0, 31);
  config.world.servo.ripple = 0.015;
  config.world.servo.ripple_period_deg = 33.0;
  config.world.servo.backlash_deg = 1.5;
  const TrueTimes recording = record(config, speeds_dps);
  const RigProfile profile = calibrated_profile(recording);
  SyncReport sync = fit(recording, profile);
  ASSERT_GE(sync.servo.ripples.size(), 1U);
  EXPECT_NEAR(sync.servo.ripples[0].period_deg, 33.0,
              0.7);  // in degrees of what is commanded: scale is in it
  EXPECT_NEAR(sizes(sync.servo.ripples[0]).first, 0.015, 0.003);
  EXPECT_NEAR(sizes(sync.servo.ripples[0]).second, 0.015, 0.003);
  const Verdict followed = judge(recording, label(recording, label_config(profile, sync, false)));
  sync.servo.ripples.clear();
  const Verdict ignored = judge(recording, label(recording, label_config(profile, sync, false)));
  EXPECT_LT(followed.rms_dps, 0.3);
  EXPECT_GT(ignored.rms_dps, 1.5 * followed.rms_dps);
}

TEST(Ripples, OfAHeadOutOfBalanceComeOnceATurn) {
  auto config = rig_of(2160.0, 8.0, 32);
  config.world.servo.load_deg = 1.2;
  const TrueTimes recording = record(config, speeds_dps);
  const SyncReport sync = fit(recording, recording.profile);
  ASSERT_EQ(sync.servo.ripples.size(), 1U);
  EXPECT_NEAR(sync.servo.ripples[0].period_deg, 360.0, 10.0);
  EXPECT_NEAR(sizes(sync.servo.ripples[0]).first, 1.2 * M_PI / 180.0, 0.005);
}

TEST(Ripples, AreNotImaginedWhereTheServoHasNone) {
  for (const std::uint64_t seed : {33, 34, 35, 36}) {
    const TrueTimes recording = record(rig_of(2160.0, 8.0, seed), speeds_dps);
    EXPECT_TRUE(fit(recording, recording.profile).servo.ripples.empty()) << seed;
  }
}

TEST(GyroNoise, ThatIsHeardInMotionAloneIsNoUnsteadinessOfTheShaft) {
  auto config = rig_of(2160.0, 8.0, 37);
  config.world.gyro.vibration_dps = 4.0;
  const TrueTimes recording = record(config, speeds_dps);
  const RigProfile profile = calibrated_profile(recording);
  const SyncReport sync = fit(recording, profile);
  for (const auto& speed : sync.servo.speeds) EXPECT_NEAR(speed.noise_dps, 4.0, 1.0) << speed.rate_dps;
  EXPECT_LT(sync.gyro.noise_dps, 1.0);
  for (const LabelConfig& config_of :
       {label_config(profile, sync, false), label_config(profile, {}, false)}) {
    const Verdict verdict = judge(recording, label(recording, config_of));
    EXPECT_LT(verdict.rejected, verdict.steady / 10);
  }
}

TEST(ServoResponse, IsTheProfilesWhereNothingMoved) {
  const TrueTimes recording = record(rig_of(180.0, 8.0, 41), {0.0});
  const ServoResponse response = fit(recording, recording.profile).servo;
  EXPECT_FALSE(response.fitted);
  EXPECT_EQ(response.loop_hz, recording.profile.servo.loop_hz);
  EXPECT_EQ(response.scale.value, recording.profile.servo.scale);
}

TEST(ServoResponse, IsNotFittedToAGyroThatTurnsTheOtherWay) {
  TrueTimes recording = record(rig_of(180.0, 8.0, 42), {60, -60, 100});
  for (TimedGyro& sample : recording.gyro) sample.rate_dps = -sample.rate_dps;
  EXPECT_FALSE(fit(recording, recording.profile).servo.fitted);
}

TEST(ServoResponse, CountsFramesAtTheSpeedsOfLegsOnly) {
  TrueTimes recording = record(rig_of(2160.0, 8.0, 43), {60, -60, 150, -150});
  const ServoResponse all = fit(recording, recording.profile).servo;
  ASSERT_EQ(all.speeds.size(), 4U);
  for (const ServoResponse::AtSpeed& speed : all.speeds) {
    EXPECT_LE(speed.frames, 32U);  // 4 s at 8 frames a second, ramps and settling in it
    EXPECT_GE(speed.frames, 26U);
  }
  for (TimedServo& message : recording.servo)  // as on the way to a start
    if (message.state.leg >= 3) message.state.leg = 0;
  const ServoResponse legs = fit(recording, recording.profile).servo;
  ASSERT_EQ(legs.speeds.size(), 2U);
  EXPECT_EQ(legs.speeds.back().rate_dps, 60.0);
}

TEST(ServoResponse, TheGyroAgreesInRampsAndReversalsToo) {
  const TrueTimes recording = record(rig_of(180.0, 8.0, 46), speeds_dps);
  const SyncReport sync = fit(recording, recording.profile);
  std::size_t ramps = 0, disagreeing = 0;
  for (const LabelledSample& sample : label(recording, label_config(recording.profile, sync, false))) {
    if ((sample.reason_bits & bit(Reason::servo_ramp)) == 0) continue;
    ++ramps;
    disagreeing += (sample.reason_bits & bit(Reason::gyro_disagrees)) != 0 ? 1 : 0;
  }
  EXPECT_GT(ramps, 50U);
  EXPECT_LE(disagreeing, ramps / 20);
}

TEST(ServoResponse, IsAsGoodAsAssumedWhereNoLegTold) {
  TrueTimes recording = record(rig_of(2160.0, 8.0, 44), {60, -60, 150});
  for (TimedServo& message : recording.servo) message.state.leg = 0;
  const ServoResponse response = fit(recording, recording.profile).servo;
  EXPECT_TRUE(response.fitted);
  EXPECT_TRUE(std::isnan(response.residual_dps));
  const SyncReport sync = fit(recording, recording.profile);
  std::size_t known = 0;
  for (const LabelledSample& sample : label(recording, label_config(recording.profile, sync, false)))
    if (std::isfinite(sample.rate_shaft_dps)) {
      EXPECT_GE(sample.rate_shaft_uncertainty_dps, 0.25F);  // what is assumed of a servo
      ++known;
    }
  EXPECT_GT(known, 100U);
}

TEST(Fits, DoNotCallPerfectWhatIsNotKnown) {
  TrueTimes recording = record(rig_of(180.0, 8.0, 45), {60, -60});
  std::erase_if(recording.servo, [](const TimedServo& m) { return m.state.motion != ServoMotion::steady; });
  SyncReport sync = fit(recording, recording.profile);
  EXPECT_TRUE(std::isnan(sync.gyro.noise_dps));
  EXPECT_TRUE(std::isnan(fit_servo_response({}, {}, sync.gyro, recording.profile.servo).residual_dps));
}

TEST(GyroErrors, BiasIsThatOfTheRests) {
  auto config = rig_of(2160.0, 8.0, 51);
  config.gyro_grade = simulation::GyroGrade::mpu6050_raw;
  const TrueTimes recording = record(config, {50, -50});
  double truth = 0.0, count = 0.0;
  for (std::size_t i = 0; i < recording.gyro.size(); ++i)
    if (std::abs(recording.sent_gyro[i].mean_rate_dps) < 1e-3) {
      truth += recording.gyro[i].rate_dps;
      count += 1.0;
    }
  truth /= count;
  const GyroErrors errors = fit_gyro_errors(recording.gyro, recording.servo, recording.profile.gyro);
  ASSERT_TRUE(errors.bias_dps);
  EXPECT_NEAR(errors.bias_dps->value, truth, 0.1);
  EXPECT_LT(errors.bias_dps->uncertainty, 0.1);
  ASSERT_TRUE(errors.bias_before_dps && errors.bias_after_dps);
  EXPECT_NEAR(*errors.bias_before_dps, *errors.bias_after_dps, 0.2);
  EXPECT_NEAR(errors.noise_dps, 0.11, 0.03);
  EXPECT_FALSE(errors.zeroes_itself);
  EXPECT_FALSE(errors.bias_from_legs);
}

TEST(GyroErrors, AHandThatTurnsTheRigAtRestDoesNotCount) {
  auto config = rig_of(2160.0, 8.0, 52);
  config.hand_turns = {{.begin = at_s(1.5), .duration_s = 3.0, .angle_deg = 90.0}};
  const TrueTimes still = record(rig_of(2160.0, 8.0, 52), {50, -50});
  const TrueTimes turned = record(config, {50, -50});
  const auto bias = [](const TrueTimes& r) {
    return fit_gyro_errors(r.gyro, r.servo, r.profile.gyro).bias_dps->value;
  };
  EXPECT_NEAR(bias(turned), bias(still), 0.1);
}

TEST(GyroErrors, OfAGyroThatZeroesItselfTheBiasComesFromLegsInBothDirections) {
  auto config = rig_of(2160.0, 8.0, 53);
  config.gyro_zeroes_itself = true;
  const TrueTimes recording = record(config, {60, -60, 120, -120});
  const GyroErrors errors = fit_gyro_errors(recording.gyro, recording.servo, recording.profile.gyro);
  EXPECT_TRUE(errors.zeroes_itself);
  EXPECT_TRUE(errors.bias_from_legs);
  double truth = 0.0, count = 0.0;  // while it moves
  const double scale = recording.gyro_scale();
  for (std::size_t i = 0; i < recording.gyro.size(); ++i)
    if (std::abs(recording.sent_gyro[i].mean_rate_dps) > 20.0) {
      truth += recording.gyro[i].rate_dps - scale * recording.sent_gyro[i].mean_rate_dps;
      count += 1.0;
    }
  EXPECT_NEAR(errors.bias_dps->value, truth / count, 3.0 * errors.bias_dps->uncertainty);
  EXPECT_LT(errors.bias_dps->uncertainty, 1.0);
}

/// A filter that fuses sensors takes what is steady for a bias, within `seconds`.
void let_decay(std::vector<TimedGyro>& gyro, double seconds) {
  double bias_dps = 0.0;
  for (std::size_t i = 1; i < gyro.size(); ++i) {
    gyro[i].rate_dps -= static_cast<float>(bias_dps);
    bias_dps += double{gyro[i].rate_dps} * to_s(gyro[i].stamp.time - gyro[i - 1].stamp.time) / seconds;
  }
}

TEST(GyroErrors, AGyroWhoseRateDecaysInASteadyTurnIsNamedAndNothingOfTheServoIsTakenFromIt) {
  for (const double seconds : {2.0, 10.0}) {
    TrueTimes recording = record(rig_of(2160.0, 8.0, 57), {60, -60, 120, -120, 60, -60, 90, -90});
    let_decay(recording.gyro, seconds);
    GyroErrors errors = fit_gyro_errors(recording.gyro, recording.servo, recording.profile.gyro);
    errors.decay_per_s = gyro_decay_per_s(recording.gyro, recording.servo, errors);
    EXPECT_GT(errors.decay_per_s, 0.4 / seconds);
    EXPECT_LT(errors.decay_per_s, 1.1 / seconds);
    EXPECT_FALSE(fit_servo_response(recording.servo, recording.gyro, errors, recording.profile.servo).fitted);
    EXPECT_TRUE(errors.bias_course.empty());
  }
}

TEST(GyroErrors, NoDecayIsSeenOfASoundGyroWhateverTheServoDoes) {
  std::uint64_t seed = 60;
  for (const char* world :
       {"honest", "typical", "hard", "honest,servo.supply_sag=0.6", "honest,servo.stick_deg=2.5",
        "honest,servo.load_deg=2", "honest,gyro.self_heating_k=10"}) {
    auto config = rig_of(2160.0, 8.0, ++seed);
    put_in_world(simulation::world_named(world, seed), config);
    const TrueTimes recording = record(config, {40, -40, 80, -80, 200, -200});
    const GyroErrors errors = fit_gyro_errors(recording.gyro, recording.servo, recording.profile.gyro);
    EXPECT_EQ(gyro_decay_per_s(recording.gyro, recording.servo, errors), 0.0) << world;
  }
}

TEST(GyroErrors, OneDirectionAloneSaysLittle) {
  auto config = rig_of(2160.0, 8.0, 54);
  config.gyro_zeroes_itself = true;
  const TrueTimes recording = record(config, {100, 100});
  const GyroErrors errors = fit_gyro_errors(recording.gyro, recording.servo, recording.profile.gyro);
  EXPECT_GT(errors.bias_dps->uncertainty, 2.0);
}

/// Of 12 s, servo and gyro a hundred times a second: rest with an arming that turns the shaft at 3 s, a drive
/// to where the leg begins, rest, a leg from 7 s on, rest. The gyro shows its bias of 5 deg/s and what turns.
struct ArmedAndDriven {
  std::vector<TimedServo> servo;
  std::vector<TimedGyro> gyro;

  explicit ArmedAndDriven(double begin_s = 0.0) {
    for (int i = static_cast<int>(100 * begin_s); i < 1200; ++i) add(0.01 * i);
  }

  GyroErrors errors() const { return fit_gyro_errors(gyro, servo, {}); }

 private:
  void add(double time_s) {
    const bool drives = 4.0 <= time_s && time_s < 5.0, leg = 7.0 <= time_s && time_s < 9.0;
    TimedServo message;
    message.stamp.time = HostTime(from_s(time_s));
    message.mcu_time_us = static_cast<std::int64_t>(std::llround(1e6 * time_s));
    message.state.motion = drives || leg  ? ServoMotion::steady
                           : time_s < 3.0 ? ServoMotion::disarmed
                                          : ServoMotion::holding;
    message.state.rate_dps = drives || leg ? 100.0 : 0.0;
    message.state.leg = leg ? 1 : 0;
    servo.push_back(message);
    const bool arms = 3.0 <= time_s && time_s < 3.2;
    const double noise_dps = servo.size() % 2 == 0 ? 0.1 : -0.1;
    TimedGyro sample;
    sample.stamp.time = message.stamp.time;
    sample.rate_dps =
        static_cast<float>(5.0 + noise_dps + message.state.rate_dps + (arms ? 1000.0 * (time_s - 3.0) : 0.0));
    sample.reading.rate_dps.fill(sample.rate_dps);
    gyro.push_back(sample);
  }
};

TEST(GyroErrors, TheJerkOfArmingIsNoPartOfTheRestBeforeTheFirstLeg) {
  const GyroErrors errors = ArmedAndDriven().errors();
  ASSERT_TRUE(errors.bias_before_dps && errors.bias_after_dps);
  EXPECT_NEAR(*errors.bias_before_dps, 5.0, 0.01);
  EXPECT_NEAR(*errors.bias_after_dps, 5.0, 0.01);
}

TEST(GyroErrors, TheRestBeforeTheFirstLegIsThatBehindTheDriveToItAsWell) {
  ArmedAndDriven drifted(3.2);  // of the rest before the drive there is less than of the one behind it
  for (TimedGyro& sample : drifted.gyro)
    if (sample.stamp.time >= HostTime(from_s(5.0))) sample.rate_dps += 0.2F;
  ASSERT_TRUE(drifted.errors().bias_before_dps);
  EXPECT_NEAR(*drifted.errors().bias_before_dps, 5.2, 0.01);
}

TEST(GyroErrors, ARestBehindTheFirstLegIsNotTheOneBefore) {
  const GyroErrors errors = ArmedAndDriven(7.5).errors();
  EXPECT_FALSE(errors.bias_before_dps);
  EXPECT_TRUE(errors.bias_after_dps);
}

TEST(Fits, SurviveWhatARecordingCanHold) {
  const RigProfile profile;
  const auto both = [&](const std::vector<TimedGyro>& gyro, const std::vector<TimedServo>& servo) {
    GyroErrors errors = fit_gyro_errors(gyro, servo, profile.gyro);
    return fit_servo_response(servo, gyro, errors, profile.servo);
  };
  EXPECT_FALSE(both({}, {}).fitted);
  EXPECT_FALSE(both({TimedGyro{}, TimedGyro{}}, {}).fitted);
  EXPECT_FALSE(both({}, {TimedServo{}, TimedServo{}}).fitted);
  const ScriptedRig rig;
  EXPECT_FALSE(both({rig.gyro_at(1), rig.gyro_at(1)}, {rig.servo_at(1), rig.servo_at(1)}).fitted);
  std::vector<TimedGyro> gyro;
  std::vector<TimedServo> servo;
  const std::vector<double> values{0.0, 1e300, -1e300, std::nan(""), std::numeric_limits<double>::infinity()};
  for (int i = 0; i < 2000; ++i) {
    servo.push_back(rig.servo_at(i % 7 == 0 ? 0.0 : 0.01 * i));
    servo.back().state.rate_dps = values[static_cast<std::size_t>(i) % values.size()];
    servo.back().state.angle_deg = values[static_cast<std::size_t>(i + 2) % values.size()];
    servo.back().state.pulse_us = i % 3 == 0 ? 0.0F : static_cast<float>(i * 37 % 4096);
    gyro.push_back(rig.gyro_at(i % 5 == 0 ? 1.0 : 0.01 * i));
    gyro.back().rate_dps = static_cast<float>(values[static_cast<std::size_t>(i) % values.size()]);
  }
  EXPECT_FALSE(both(gyro, servo).fitted);
}

TEST(Fits, AreQuickWhereTheLastMessageCameAgesLater) {
  TrueTimes recording = record(rig_of(2160.0, 8.0, 55), {60, -60, 120, -120});
  recording.servo.back().stamp.time += from_s(9e9);
  recording.gyro.back().stamp.time += from_s(9e9);
  const RigProfile& profile = recording.profile;
  GyroErrors errors = fit_gyro_errors(recording.gyro, recording.servo, profile.gyro);
  EXPECT_TRUE(errors.bias_before_dps);
  EXPECT_TRUE(fit_servo_response(recording.servo, recording.gyro, errors, profile.servo).fitted);
}

}  // namespace
}  // namespace thermorig::fit
