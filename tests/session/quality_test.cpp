// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include "synthetic_session.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::session {
namespace {

Session clean_session(std::size_t frames) {
  Session session = synthetic_session(frames);
  session.counters[Device::gyro] = {.messages = session.gyro.size()};
  session.counters[Device::servo] = {.messages = session.servo.size()};
  GyroErrors& gyro = session.sync.gyro;
  gyro.zeroes_itself = gyro.scale_contradicts = gyro.filter_contradicts = false;
  gyro.bias_course.clear();
  session.sync.camera_offset.contradicts = false;
  for (auto& speed : session.sync.servo.speeds) speed.contradicts = false;
  for (const Device device : all_devices) {
    session.sync.clock[device].epochs.clear();
    session.sync.clock[device].gaps.clear();
    session.sync.clock[device].own_time_unused.clear();
  }
  return session;
}

TEST(Quality, CountsFramesByReasonAndSpeed) {
  const Quality quality = quality_of(clean_session(150));
  EXPECT_EQ(quality.frames, 150U);
  EXPECT_EQ(quality.swept, 150U);
  EXPECT_EQ(quality.valid, 141U);
  EXPECT_EQ(quality.reason_counts.at("servo_ramp"), 9U);
  EXPECT_EQ(quality.reason_counts.count("checksum"), 0U);
  ASSERT_EQ(quality.speeds.size(), 3U);
  EXPECT_EQ(quality.speeds[0].rate_dps, 7.5);
  EXPECT_EQ(quality.speeds[0].frames, 60);
  EXPECT_EQ(quality.speeds[0].valid, 57);
  EXPECT_EQ(quality.speeds[2].frames, 30);
  EXPECT_EQ(quality.verdict, "good");
  EXPECT_TRUE(quality.verdict_reasons.empty());
}

TEST(Quality, RatesAreNotQuantisedByTheirWindows) {
  const Quality quality = quality_of(clean_session(150));
  const auto& camera = quality.stream[Device::camera];
  EXPECT_NEAR(camera.rate_min_hz, 8.0, 1e-6);
  EXPECT_NEAR(camera.rate_max_hz, 8.0, 1e-6);
  EXPECT_NEAR(quality.stream[Device::gyro].rate_mean_hz, 200.0, 1e-6);
  EXPECT_NEAR(camera.gap_max_s, 0.125, 1e-6);
}

TEST(Quality, MessagesThatAreDamagedInAnyWayAreBadOnes) {
  Session session = clean_session(150);
  session.counters[Device::camera] = {.messages = 150, .bad_checksum = 20, .bad_length = 3, .bad_value = 1};
  const Quality quality = quality_of(session);
  EXPECT_EQ(quality.stream[Device::camera].bad, 24U);
  EXPECT_EQ(quality.verdict, "bad");
}

TEST(Quality, MissingFramesAreLostAndLeaveAGap) {
  Session session = clean_session(150);
  session.frames.erase(session.frames.begin() + 50, session.frames.begin() + 53);
  session.frames[50].missing_before = 3;
  const Quality quality = quality_of(session);
  EXPECT_EQ(quality.stream[Device::camera].lost, 3U);
  EXPECT_NEAR(quality.stream[Device::camera].gap_max_s, 0.5, 1e-6);
  EXPECT_EQ(quality.verdict, "usable");
}

TEST(Quality, SamplesThatTheGyrosRateLacksAreLost) {
  Session session = clean_session(150);
  const HostTime begin = session.gyro[100].stamp.time;
  session.sync.clock[Device::gyro].rate_hz = 200.0;
  session.sync.clock[Device::gyro].gaps = {{begin, begin + from_s(0.18), 35}};
  const Quality quality = quality_of(session);
  EXPECT_EQ(quality.stream[Device::gyro].lost, 35U);
  EXPECT_EQ(quality.verdict, "usable");
}

TEST(Quality, AGapLacksNoMoreSamplesThanItHasRoomFor) {
  Session session = clean_session(150);
  const HostTime begin = session.gyro[100].stamp.time;
  session.sync.clock[Device::gyro].rate_hz = 200.0;
  session.sync.clock[Device::gyro].gaps = {{begin, begin + from_s(0.1), 1'000'000'000'000}};
  EXPECT_EQ(quality_of(session).stream[Device::gyro].lost, 21U);
}

TEST(Quality, WhatAGyroThatWasAwaitedDidNotSendIsNotLost) {
  Session session = clean_session(150);
  const HostTime begin = session.gyro[100].stamp.time;
  session.sync.clock[Device::gyro].gaps = {{begin, begin + from_s(5.0), 999}};
  session.raw.events.push_back({begin + from_s(3.0), EventKind::device_lost, Device::gyro, "unplugged"});
  EXPECT_EQ(quality_of(session).stream[Device::gyro].lost, 0U);
}

TEST(Quality, FramesThatRepeatTheOneBeforeAreCounted) {
  Session session = clean_session(20);
  session.frames[4].fresh_even = session.frames[4].fresh_odd = 0;
  EXPECT_EQ(quality_of(session).stream[Device::camera].repeated, 1U);
}

TEST(Verdict, IsBadWithoutAValidFrameAndSaysSo) {
  Session session = clean_session(60);
  for (auto& sample : session.samples) sample.valid = false;
  const Quality quality = quality_of(session);
  EXPECT_EQ(quality.verdict, "bad");
  EXPECT_THAT(quality.verdict_reasons, testing::Contains("no frame is valid"));
}

TEST(Verdict, IsBadWhenMoreThanATwentiethWasLost) {
  Session session = clean_session(60);
  session.counters[Device::gyro].lost = session.gyro.size() / 10;
  EXPECT_EQ(quality_of(session).verdict, "bad");
}

/// Each missing frame is noticed, and only the frames at it are invalid.
TEST(Verdict, IsUsableWhenACameraLosesAThirdOfItsFramesAndBadBeyond) {
  Session session = clean_session(60);
  for (std::size_t i = 1; i < 60; i += 2) session.frames[i].missing_before = 1;
  EXPECT_EQ(quality_of(session).verdict, "usable");
  for (std::size_t i = 1; i < 60; i += 2) session.frames[i].missing_before = 2;
  EXPECT_EQ(quality_of(session).verdict, "bad");
}

TEST(Verdict, IsBadWhenADeviceSentNothing) {
  Session session = clean_session(60);
  session.counters[Device::servo] = {};
  EXPECT_EQ(quality_of(session).verdict, "bad");
}

TEST(Verdict, IsUsableWhenASpeedHasNoValidFrame) {
  Session session = clean_session(150);
  for (auto& sample : session.samples)
    if (sample.leg == 2) sample.valid = false;
  const Quality quality = quality_of(session);
  EXPECT_EQ(quality.verdict, "usable");
  EXPECT_THAT(quality.verdict_reasons, testing::Contains("1 of 3 speeds have no valid frame"));
}

TEST(Verdict, IsUsableWhenFewerThanHalfOfTheFramesAreValid) {
  Session session = clean_session(150);
  for (std::size_t i = 0; i < session.samples.size(); ++i)
    session.samples[i].valid = session.samples[i].valid && i % 3 == 0;
  const Quality quality = quality_of(session);
  EXPECT_EQ(quality.verdict, "usable");
  EXPECT_THAT(quality.verdict_reasons,
              testing::Contains(testing::HasSubstr("of 150 frames within legs are valid")));
}

TEST(Verdict, QuotesTheFirstOfReasonsWithoutADuration) {
  Session session = clean_session(60);
  session.sync.clock[Device::servo].epochs = {{host_time_ns(1), ""},
                                              {host_time_ns(2), "the board was reset"},
                                              {host_time_ns(3), "it was reset again"}};
  EXPECT_THAT(quality_of(session).verdict_reasons,
              testing::Contains("the clock of the servo was reset 2 times, most: the board was reset"));
}

TEST(Quality, FramesThatACameraDidNotSendWhileItWasAwaitedAreNotLost) {
  Session session = clean_session(150);
  session.frames[50].missing_before = 3;
  EXPECT_EQ(quality_of(session).stream[Device::camera].lost, 3U);
  const RecordingEvent lost{session.frames[49].stamp.arrival, EventKind::device_lost, Device::camera,
                            "unplugged"};
  session.raw.events.push_back(lost);
  EXPECT_EQ(quality_of(session).stream[Device::camera].lost, 0U);
  session.raw.events.back().source = Device::gyro;  // another device's absence does not excuse them
  EXPECT_EQ(quality_of(session).stream[Device::camera].lost, 3U);
}

TEST(Verdict, IsUsableWhenRecoveredOrADeviceWasLost) {
  Session session = clean_session(60);
  session.state = State::recovered;
  EXPECT_EQ(quality_of(session).verdict, "usable");
  session.state = State::complete;
  session.raw.events.push_back({host_time_ns(1), EventKind::device_lost, Device::gyro, "unplugged"});
  EXPECT_EQ(quality_of(session).verdict, "usable");
}

TEST(Quality, SaysHowWellTimesAndLabelsAreKnown) {
  const Session session = clean_session(60);
  const Quality quality = quality_of(session);
  EXPECT_DOUBLE_EQ(quality.clock[Device::gyro].uncertainty_s, 120e-6);
  EXPECT_DOUBLE_EQ(quality.clock[Device::servo].bound_s, 300e-6);
  EXPECT_EQ(quality.camera_offset_s, (Estimate{0.012, 0.0005}));
  EXPECT_FLOAT_EQ(static_cast<float>(quality.rate_shaft_uncertainty_dps), 0.1F);
}

TEST(Quality, DoesNotInventWhatWasNotFitted) {
  Session session = clean_session(60);
  session.sync = {};
  const Quality quality = quality_of(session);
  EXPECT_TRUE(std::isnan(quality.clock[Device::camera].uncertainty_s));
  EXPECT_TRUE(std::isnan(quality.gyro_residual_dps));
  EXPECT_FALSE(quality.camera_offset_s);
  EXPECT_EQ(quality.verdict, "good");
}

TEST(Verdict, IsUsableWhenAClockIsUnsureOrBeganAnew) {
  Session session = clean_session(60);
  session.sync.clock[Device::gyro].uncertainty_us = 2800;
  session.sync.clock[Device::servo].epochs = {{host_time_ns(1), ""}, {host_time_ns(2), "a reset"}};
  const Quality quality = quality_of(session);
  EXPECT_EQ(quality.verdict, "usable");
  EXPECT_THAT(quality.verdict_reasons, testing::Contains("the times of the gyro are known to 2.8 ms only"));
  EXPECT_THAT(quality.verdict_reasons, testing::Contains("the clock of the servo was reset once: a reset"));
}

TEST(Verdict, TellsWhyAClockIsUnsureThatWanders) {
  Session session = clean_session(60);
  session.sync.clock[Device::servo].uncertainty_us = 2800;
  session.sync.clock[Device::servo].wander_ppm = 384;
  EXPECT_THAT(quality_of(session).verdict_reasons,
              testing::Contains("the times of the servo are known to 2.8 ms only: its clock and the host's "
                                "wander by 384 ppm (a resonator, or NTP that slews the host's clock)"));
}

TEST(Verdict, SaysNothingOfADelayThatEachHubBrings) {
  Session session = clean_session(60);
  session.sync.clock[Device::camera].largest_constant_delay_s = 0.0033;
  const Quality quality = quality_of(session);
  EXPECT_EQ(quality.verdict, "good");
  EXPECT_THAT(quality.verdict_reasons, testing::IsEmpty());
}

TEST(Verdict, IsUsableWhenLinksAreSlowerThanTheirProfileSays) {
  Session session = clean_session(60);
  session.sync.clock[Device::camera].largest_constant_delay_s = 0.0163;
  session.sync.clock[Device::gyro].largest_constant_delay_s = 0.0163;
  const Quality quality = quality_of(session);
  EXPECT_EQ(quality.verdict, "usable");
  EXPECT_THAT(
      quality.verdict_reasons,
      testing::Contains(
          "the times of the camera and the gyro may be up to 16.3 ms late; a USB hub can cause this"));
}

TEST(Verdict, CountsEachDeviceThatWentOnce) {
  const auto reasons_of = [](std::initializer_list<std::pair<EventKind, std::optional<Device>>> events) {
    Session session = clean_session(60);
    for (const auto& [kind, device] : events) session.raw.events.push_back({{}, kind, device, ""});
    return quality_of(session).verdict_reasons;
  };
  const auto lost = EventKind::device_lost, back = EventKind::device_back;
  const std::optional<Device> camera = Device::camera, gyro = Device::gyro, servo = Device::servo, rig;
  EXPECT_THAT(reasons_of({{lost, camera}, {lost, gyro}, {lost, servo}, {lost, rig}}),
              testing::ElementsAre("devices were lost 3 times"))
      << "and the recording ended because they stayed away";
  EXPECT_THAT(reasons_of({{lost, camera}, {lost, camera}, {back, camera}}),
              testing::ElementsAre("a device was lost once"))
      << "it went again before it was there";
  EXPECT_THAT(reasons_of({{lost, camera}, {back, camera}, {lost, camera}}),
              testing::ElementsAre("devices were lost 2 times"));
  EXPECT_THAT(reasons_of({{lost, rig}}), testing::ElementsAre("a device was lost once"));
}

TEST(Losses, AreToldOfAStreamThatLostMoreThanAGoodSessionMay) {
  Quality::Stream stream{.received = 950, .lost = 40, .bad = 10};
  EXPECT_EQ(losses_text(Device::camera, stream), "5.0 % of the camera's messages were lost or damaged");
  stream = {.received = 996, .lost = 4};
  EXPECT_EQ(losses_text(Device::camera, stream), "");
}

/// A session whose gyro reads `off_dps` too much in every frame.
Quality quality_with_gyro_off_by(float off_dps) {
  Session session = clean_session(60);
  session.sync.gyro.bias_dps = Estimate{0.0, 0.1};
  session.sync.gyro.scale.value = session.sync.servo.scale.value = session.sync.servo.gyro_ratio.value = 1.0;
  for (auto& sample : session.samples) sample.rate_gyro_dps = sample.rate_shaft_dps + off_dps;
  session.samples[0].rate_gyro_dps += 1000.0F;  // in a ramp: it does not count
  return quality_of(session);
}

TEST(Verdict, CountsHowFarGyroAndLabelsLieApart) {
  EXPECT_NEAR(quality_with_gyro_off_by(0.5F).gyro_residual_dps, 0.5, 1e-4);
  EXPECT_EQ(quality_with_gyro_off_by(0.5F).verdict, "good");
  EXPECT_EQ(quality_with_gyro_off_by(2.0F).verdict, "usable");
  EXPECT_EQ(quality_with_gyro_off_by(6.0F).verdict, "bad");
}

TEST(Verdict, IsBadWhenTimesAreNoBetterThanArrivals) {
  Session session = clean_session(60);
  session.sync.clock[Device::camera].uncertainty_us = 12'000;
  EXPECT_EQ(quality_of(session).verdict, "bad");
}

TEST(Verdict, ARestForACalibrationNeedsNoValidFrame) {
  Session session = clean_session(60);
  session.raw.legs.clear();
  for (auto& sample : session.samples) {
    sample.leg = 0;
    sample.valid = false;
  }
  EXPECT_EQ(quality_of(session).verdict, "bad");
  session.raw.header.plan_toml = "name = \"rest\"\nfor_calibration = true\nleg_rates_dps = []\n";
  EXPECT_EQ(quality_of(session).verdict, "good");
}

TEST(Verdict, QuotesTheLargestContradictionOfAClock) {
  Session session = clean_session(60);
  const auto contradiction = [](const std::string& by) {
    return "bounds contradict each other by " + by + ": one of the two clocks jumped";
  };
  session.sync.clock[Device::servo].epochs = {{host_time_ns(1), ""},
                                              {host_time_ns(2), contradiction("0.31 ms")},
                                              {host_time_ns(3), contradiction("2.5 s")},
                                              {host_time_ns(4), contradiction("21.07 ms")}};
  EXPECT_THAT(quality_of(session).verdict_reasons,
              testing::Contains("the clock of the servo was reset 3 times, most: " + contradiction("2.5 s")));
}

TEST(Verdict, IsUsableWhenTheGyroHidesItsBiasOrContradicts) {
  Session session = clean_session(60);
  session.sync.gyro.zeroes_itself = true;
  for (std::size_t i = 0; i < 12; ++i) session.samples[i].reason_bits |= bit(Reason::gyro_disagrees);
  const Quality quality = quality_of(session);
  EXPECT_EQ(quality.verdict, "usable");
  EXPECT_THAT(quality.verdict_reasons, testing::Contains(testing::HasSubstr("zeroes itself")));
  EXPECT_THAT(quality.verdict_reasons,
              testing::Contains("gyro and servo disagree in 16 % of the frames that are otherwise valid"));
}

TEST(Verdict, OfAGyroThatHidesItsBiasStaysGoodWhereEqualSpeedsBothWaysTellIt) {
  Session session = clean_session(60);
  session.sync.gyro.zeroes_itself = session.sync.gyro.bias_from_legs = true;
  session.sync.gyro.bias_dps = Estimate{0.02, 0.04};
  EXPECT_EQ(quality_of(session).verdict, "good");
  EXPECT_THAT(quality_of(session).verdict_reasons,
              testing::Contains(testing::HasSubstr("from both directions: 0.02 +- 0.04 deg/s")));
  session.sync.gyro.bias_dps->uncertainty = 0.5;  // one direction alone
  EXPECT_EQ(quality_of(session).verdict, "usable");
}

TEST(Verdict, NamesAGyroWhoseRateDecaysInASteadyTurn) {
  Session session = clean_session(60);
  session.sync.gyro.decay_per_s = 0.12;
  EXPECT_EQ(quality_of(session).verdict, "bad");
  EXPECT_THAT(quality_of(session).verdict_reasons,
              testing::Contains(testing::HasSubstr("the gyro's rate falls by 12 % a second")));
}

TEST(Verdict, SaysThatTimesOfNoSamplesWereNotUsedAndIsNoLowerForIt) {
  Session session = clean_session(60);
  session.sync.clock[Device::gyro].own_time_unused = "90 % of them follow the one before at once";
  session.raw.header.profile.gyro.text.time = 0;
  EXPECT_EQ(quality_of(session).verdict, "good");
  EXPECT_THAT(quality_of(session).verdict_reasons, testing::Contains(testing::HasSubstr("time_column = -1")));
}

TEST(Verdict, NamesWhoContradictsTheStatedBandwidth) {
  Session session = clean_session(60);
  session.raw.header.profile.gyro.bandwidth_hz = 188.0;
  session.sync.gyro.filter_contradicts = true;
  session.sync.gyro.filter_delay_s = {0.01125, 0.0011};
  for (const auto& [source, who] : {std::pair("device", "the device itself"), {"noise", "its noise"}}) {
    session.sync.gyro.filter_source = source;
    EXPECT_EQ(quality_of(session).verdict, "usable");
    EXPECT_THAT(quality_of(session).verdict_reasons,
                testing::Contains("the gyro's bandwidth is stated as 188 Hz, and " + std::string(who) +
                                  " contradicts that: its filter delays by 11.2 +- 1.1 ms"));
  }
}

TEST(Verdict, DoesNotHoldAgainstTheRigWhatTheGyroSaysInRamps) {
  Session session = clean_session(60);
  for (std::size_t i = 0; i < 30; ++i) {
    session.samples[i].valid = false;
    session.samples[i].reason_bits |= bit(Reason::gyro_disagrees) | bit(Reason::servo_ramp);
  }
  const Quality quality = quality_of(session);
  EXPECT_EQ(quality.reason_counts.at("gyro_disagrees"), 30U);
  EXPECT_EQ(quality.disagreeing, 0U);
  EXPECT_THAT(quality.verdict_reasons, testing::Not(testing::Contains(testing::HasSubstr("disagree"))));
}

TEST(Quality, AnEmptySessionIsBadAndDividesByNothing) {
  const Quality quality = quality_of(synthetic_session(0));
  EXPECT_EQ(quality.verdict, "bad");
  EXPECT_EQ(quality.stream[Device::camera].rate_mean_hz, 0.0);
}

}  // namespace
}  // namespace thermorig::session
