// SPDX-License-Identifier: MIT
#include "thermorig/rig/recording/preflight.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "rig/recording/preflight_watch.h"
#include "rig/simulated_bus.h"
#include "thermorig/core/error.h"

namespace thermorig::rig::test {
namespace {

using ::testing::HasSubstr;

VirtualOptions checked(const TemporaryFolder& folder, const RigProfile& profile, PreflightMode mode) {
  VirtualOptions options;
  options.recording = recording_options(folder, profile, short_plan());
  options.recording.preflight = mode;
  return options;
}

/// A rig whose gyro sends half as often as its profile says.
struct SlowGyro {
  simulation::VirtualRigConfig config = simulation::default_rig(1, "kitchen");
  RigProfile profile = config.profile;
  SlowGyro() { config.profile.gyro.output_rate_hz = 0.5 * profile.gyro.output_rate_hz; }
};

std::optional<Error> error_of(DeviceBus& bus, const VirtualOptions& options) {
  try {
    record_virtual(bus, options);
  } catch (const Error& error) {
    return error;
  }
  return std::nullopt;
}

double shaft_travel_deg(const SimulatedBus& bus) {
  const auto [least, most] =
      std::minmax_element(bus.rig.shaft().begin(), bus.rig.shaft().end(),
                          [](const auto& a, const auto& b) { return a.angle_deg < b.angle_deg; });
  return most->angle_deg - least->angle_deg;
}

TEST(Preflight, LetsAGoodRigPassAndKeepsItsFigures) {
  const TemporaryFolder folder;
  SimulatedBus bus(simulation::default_rig(1, "kitchen"));
  const RecordingResult result =
      record_virtual(bus, checked(folder, simulation::default_profile(), PreflightMode::refuse));
  EXPECT_EQ(result.exit, ExitCode::ok) << result.message;
  ASSERT_TRUE(result.preflight);
  EXPECT_TRUE(result.preflight->passed());
  EXPECT_NEAR(result.preflight->facts.streams[Device::gyro]->rate_hz, 200.0, 4.0);
  EXPECT_GE(result.preflight->facts.span_s, 3.0);
}

TEST(Preflight, EverySimulatedRigPasses) {
  for (const auto grade : {simulation::GyroGrade::calibrated, simulation::GyroGrade::typical,
                           simulation::GyroGrade::mpu6050_raw})
    for (const bool half_fresh : {true, false})
      for (const auto link :
           {simulation::UsbLink::ftdi, simulation::UsbLink::ch340, simulation::UsbLink::cdc}) {
        simulation::VirtualRigConfig config = simulation::default_rig(5, "garden");
        config.gyro_grade = grade;
        config.half_fresh = half_fresh;
        for (const Device device : all_devices) config.links[device].kind = link;
        SimulatedBus bus(config);
        const TemporaryFolder folder;
        VirtualOptions options = checked(folder, config.profile, PreflightMode::refuse);
        options.recording.keep = false;
        EXPECT_FALSE(error_of(bus, options))
            << static_cast<int>(grade) << half_fresh << static_cast<int>(link);
      }
}

TEST(Preflight, RefusesARigBeforeAnythingMovesAndLeavesNoFile) {
  const TemporaryFolder folder;
  const SlowGyro rig;
  SimulatedBus bus(rig.config);
  bus.rig.keep_truth(true);
  const auto error = error_of(bus, checked(folder, rig.profile, PreflightMode::refuse));
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ExitCode::check_failed);
  EXPECT_THAT(error->what_happened(), HasSubstr("the limit is 160 to 250 (nominal 200)"));
  EXPECT_THAT(error->advice(), HasSubstr("output_rate_hz"));
  EXPECT_THAT(error->advice(), HasSubstr("--no-preflight"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  EXPECT_EQ(shaft_travel_deg(bus), 0.0);
}

TEST(Preflight, OnlyWarnsWhereItIsToldTo) {
  const TemporaryFolder folder;
  const SlowGyro rig;
  SimulatedBus bus(rig.config);
  const RecordingResult result = record_virtual(bus, checked(folder, rig.profile, PreflightMode::warn));
  ASSERT_TRUE(result.preflight);
  EXPECT_FALSE(result.preflight->passed());
  const session::Session session = session::read_session(result.session);
  const bool told = std::any_of(session.raw.events.begin(), session.raw.events.end(), [](const auto& event) {
    return event.kind == EventKind::warning && event.message.starts_with("preflight: the gyro sends 100.");
  });
  EXPECT_TRUE(told);
}

TEST(Preflight, WarnsOfAGyroThatZeroesItselfAndLetsItPass) {
  const TemporaryFolder folder;
  simulation::VirtualRigConfig config = simulation::default_rig(1, "kitchen");
  config.gyro_zeroes_itself = true;
  SimulatedBus bus(config);
  const RecordingResult result = record_virtual(bus, checked(folder, config.profile, PreflightMode::refuse));
  ASSERT_TRUE(result.preflight);
  EXPECT_TRUE(result.preflight->passed());
  ASSERT_EQ(result.preflight->warnings.size(), 1U);
  EXPECT_EQ(result.preflight->warnings.front().name, "gyro_zeroes");
  const session::Session session = session::read_session(result.session);
  const bool told = std::any_of(session.raw.events.begin(), session.raw.events.end(), [](const auto& event) {
    return event.kind == EventKind::warning && event.message.starts_with("preflight: the gyro zeroes itself");
  });
  EXPECT_TRUE(told);
  EXPECT_THAT(result.quality.verdict_reasons, testing::Contains(HasSubstr("zeroes itself")));
}

TEST(Preflight, OfARestMovesNothingAndSoOnlyWarns) {
  const TemporaryFolder folder;
  const SlowGyro rig;
  SimulatedBus bus(rig.config);
  VirtualOptions options = checked(folder, rig.profile, PreflightMode::refuse);
  options.recording.plan.leg_rates_dps.clear();
  EXPECT_FALSE(error_of(bus, options));
}

TEST(Preflight, ListensBeforeTheServoIsArmed) {
  const TemporaryFolder folder;
  SimulatedBus bus(simulation::default_rig(1, "kitchen"));
  bus.rig.keep_truth(true);
  VirtualOptions options = checked(folder, simulation::default_profile(), PreflightMode::refuse);
  std::optional<double> armed_after_s;
  options.progress_period = std::chrono::milliseconds(10);
  options.progress = [&](const RecordingProgress& progress) {
    if (!armed_after_s && progress.sweep.phase != SweepPhase::waiting) armed_after_s = progress.heard_s;
  };
  record_virtual(bus, options);
  ASSERT_TRUE(armed_after_s);
  EXPECT_GE(*armed_after_s, 3.0);
  EXPECT_LT(*armed_after_s, 3.1);
}

/// Start is allowed `wait_s` after the rig was switched on.
VirtualOptions waiting(const TemporaryFolder& folder, double wait_s) {
  VirtualOptions options = checked(folder, simulation::default_profile(), PreflightMode::refuse);
  options.recording.wait_for_start = true;
  const auto time = std::make_shared<HostTime>();
  options.progress_period = std::chrono::milliseconds(10);
  options.progress = [time](const RecordingProgress& progress) { *time = progress.time; };
  options.orders = [time, wait_s]() -> std::vector<Order> {
    if (*time < HostTime(from_s(wait_s))) return {};
    return {{OrderKind::start, ""}};
  };
  return options;
}

bool within(HostTime now, double begin_s, double end_s) {
  return now >= HostTime(from_s(begin_s)) && now < HostTime(from_s(end_s));
}

SimulatedBus::Damage spoilt(double begin_s, double end_s) {
  return [=](std::vector<std::uint8_t> bytes, HostTime now) {
    if (within(now, begin_s, end_s))
      for (std::uint8_t& byte : bytes) byte ^= 0x55U;
    return bytes;
  };
}

TEST(Preflight, ForgetsLossesOfLongAgo) {
  const TemporaryFolder folder;
  SimulatedBus bus(simulation::default_rig(1, "kitchen"));
  bus.from_device[index_of(Device::gyro)] = spoilt(5.0, 7.0);
  EXPECT_FALSE(error_of(bus, waiting(folder, 20.0)));
}

TEST(Preflight, DoesNotDiluteLossesOfJustNow) {
  const TemporaryFolder folder;
  SimulatedBus bus(simulation::default_rig(1, "kitchen"));
  bus.from_device[index_of(Device::gyro)] = spoilt(119.0, 119.5);
  const auto error = error_of(bus, waiting(folder, 120.0));
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ExitCode::check_failed);
  EXPECT_THAT(error->what_happened(), HasSubstr("bytes are in no valid message"));
}

TEST(Preflight, ListensAnewOnceADeviceThatWasAwayIsBack) {
  const TemporaryFolder folder;
  SimulatedBus bus(simulation::default_rig(1, "kitchen"));
  bus.unplugged = {{Device::camera, HostTime(from_s(15.0)), HostTime(from_s(21.0))}};
  VirtualOptions options = waiting(folder, 20.0);
  options.recording.replug_patience_s = 30.0;
  std::optional<HostTime> armed;
  options.progress = [&, told = options.progress](const RecordingProgress& progress) {
    told(progress);
    if (!armed && progress.sweep.phase != SweepPhase::waiting) armed = progress.time;
  };
  EXPECT_FALSE(error_of(bus, options));
  ASSERT_TRUE(armed);
  EXPECT_GT(*armed, HostTime(from_s(24.0)));
}

TEST(Preflight, RefusesADeviceThatHasFallenSilent) {
  const TemporaryFolder folder;
  SimulatedBus bus(simulation::default_rig(1, "kitchen"));
  bus.is_cut = [](Device device, HostTime now) {
    return device == Device::camera && now >= HostTime(from_s(18.0));
  };
  const auto error = error_of(bus, waiting(folder, 20.0));
  ASSERT_TRUE(error);
  EXPECT_THAT(error->what_happened(), HasSubstr("the camera sends"));
}

TEST(Preflight, LetsRepeatedFramesPassByTheirName) {
  const TemporaryFolder folder;
  simulation::VirtualRigConfig config = simulation::default_rig(1, "kitchen");
  config.world.camera.repeated_frames = 0.05;
  SimulatedBus bus(config);
  const RecordingResult result = record_virtual(bus, checked(folder, config.profile, PreflightMode::refuse));
  ASSERT_EQ(result.exit, ExitCode::ok) << result.message;
  const session::Quality quality = session::quality_of(session::read_session(result.session));
  const session::Quality::Stream& camera = quality.stream[Device::camera];
  EXPECT_EQ(camera.lost, 0U);
  EXPECT_GT(camera.repeated, 0U);
}

std::vector<std::string> names_of(const std::vector<PreflightViolation>& violations) {
  std::vector<std::string> names;
  for (const PreflightViolation& violation : violations) names.push_back(violation.name);
  return names;
}

PreflightFacts seen_in_three_seconds(const PreflightImages& images) {
  PreflightFacts facts;
  facts.images = images;
  facts.images->frames = 24;
  return facts;
}

TEST(Preflight, WarnsOfAFewRepeatedFramesAndRefusesMany) {
  PreflightFacts facts =
      seen_in_three_seconds({.even_fresh_share = 0.5, .odd_fresh_share = 0.5, .repeated_share = 3.0 / 24.0});
  const PreflightReport few = judge(facts, simulation::default_profile());
  EXPECT_TRUE(few.passed());  // so many come of a bridge that repeats one in thirty, one time in thirty
  EXPECT_THAT(names_of(few.warnings), ::testing::ElementsAre("camera_repeats"));
  facts.images->repeated_share = 0.5;
  const PreflightReport many = judge(facts, simulation::default_profile());
  EXPECT_THAT(names_of(many.violations), ::testing::ElementsAre("camera_repeats"));
  EXPECT_THAT(many.warnings, ::testing::IsEmpty());
}

/// Frames with a lost half are invalid one by one, and the plan goes on until each speed has its frames.
TEST(Preflight, WarnsOfLostHalvesAndSaysWhatBecomesOfTheSession) {
  PreflightFacts facts =
      seen_in_three_seconds({.even_fresh_share = 0.5, .odd_fresh_share = 0.5, .lost_half_share = 0.2});
  facts.streams[Device::camera] = PreflightStream{
      .messages = 24, .rate_hz = 6.4, .nominal_hz = 8.0, .lost_share = 0.2, .uncertainty_s = 0.001};
  const PreflightReport some = judge(facts, simulation::default_profile());
  EXPECT_TRUE(some.passed());
  ASSERT_THAT(names_of(some.warnings), ::testing::ElementsAre("camera_halves"));
  EXPECT_THAT(sentence(some.warnings.front()), HasSubstr("the recording goes on"));
  EXPECT_THAT(sentence(some.warnings.front()), HasSubstr("usable, or bad if more than 35 % are missing"));
}

TEST(Preflight, RefusesACameraThatSurelyLosesMoreHalvesThanASessionBears) {
  PreflightFacts facts =
      seen_in_three_seconds({.even_fresh_share = 0.5, .odd_fresh_share = 0.5, .lost_half_share = 0.5});
  EXPECT_TRUE(judge(facts, simulation::default_profile()).passed());
  facts.images->lost_half_share = 0.7;
  EXPECT_THAT(names_of(judge(facts, simulation::default_profile()).violations),
              ::testing::ElementsAre("camera_halves"));
}

/// A camera sends some 24 frames in three seconds, so one of them is 4 %.
TEST(Preflight, WarnsOfAMissingFrameAndRefusesACameraThatSurelyLosesTooMany) {
  PreflightFacts facts;
  facts.streams[Device::camera] = PreflightStream{
      .messages = 23, .rate_hz = 7.7, .nominal_hz = 8.0, .lost_share = 1.0 / 24.0, .uncertainty_s = 0.001};
  const PreflightReport one = judge(facts, simulation::default_profile());
  EXPECT_TRUE(one.passed());
  ASSERT_THAT(names_of(one.warnings), ::testing::ElementsAre("camera_lost"));
  EXPECT_THAT(sentence(one.warnings.front()), HasSubstr("the verdict will be usable"));
  facts.streams[Device::camera]->messages = 16;
  facts.streams[Device::camera]->rate_hz = 5.3;  // no other rate than 8, of which a third is missing
  facts.streams[Device::camera]->lost_share = 1.0 / 3.0;
  EXPECT_TRUE(judge(facts, simulation::default_profile()).passed());
  facts.streams[Device::camera]->messages = 7;
  facts.streams[Device::camera]->rate_hz = 2.3;
  facts.streams[Device::camera]->lost_share = 0.7;
  EXPECT_THAT(names_of(judge(facts, simulation::default_profile()).violations),
              ::testing::ElementsAre("camera_lost"));
}

/// Which of the two is new is chance where halves are lost.
TEST(Preflight, RefusesAHalfThatStandsStillAndNotOneThatIsSeldomNewByChance) {
  PreflightFacts facts =
      seen_in_three_seconds({.even_fresh_share = 0.2, .odd_fresh_share = 0.8, .lost_half_share = 0.3});
  EXPECT_TRUE(judge(facts, simulation::default_profile()).passed());
  facts.images->even_fresh_share = 0.0;
  EXPECT_THAT(names_of(judge(facts, simulation::default_profile()).violations),
              ::testing::ElementsAre("camera_fresh"));
}

TEST(Preflight, CallsHalvesThatABridgeMissesNeitherRepeatedNorASlowRate) {
  const TemporaryFolder folder;
  simulation::VirtualRigConfig config = simulation::default_rig(1, "kitchen");
  config.world.camera.lost_subpages = 0.33;
  SimulatedBus bus(config);
  const RecordingResult result = record_virtual(bus, checked(folder, config.profile, PreflightMode::refuse));
  ASSERT_EQ(result.exit, ExitCode::finished_lossy) << result.message;
  EXPECT_THAT(names_of(result.preflight->warnings), ::testing::ElementsAre("camera_halves"));
  EXPECT_EQ(result.quality.verdict, "usable");
  EXPECT_THAT(result.quality.verdict_reasons, ::testing::Contains(HasSubstr("camera's messages were lost")));
}

TEST(Preflight, JudgesABiasThatWasMeasured) {
  RigProfile profile = simulation::default_profile();
  PreflightFacts facts;
  facts.rest = PreflightRest{.mean_dps = 4.0, .noise_dps = 0.1};
  EXPECT_TRUE(judge(facts, profile).passed());  // nobody has measured it
  profile.gyro.bias_dps = 1.0;
  profile.gyro.bias_uncertainty_dps = 0.1;
  profile.gyro.bias_measured_utc = "2026-07-25T14:35:12Z";
  const PreflightReport report = judge(facts, profile);
  ASSERT_EQ(report.violations.size(), 1U);
  EXPECT_EQ(report.violations[0].name, "gyro_bias");
  EXPECT_THAT(report.violations[0].advice, HasSubstr("a cold gyro has another bias"));
  facts.rest->mean_dps = 1.9;
  EXPECT_TRUE(judge(facts, profile).passed());
}

/// As a sketch sends it that empties the gyro's FIFO: ten samples in a row, all with one time.
TEST(Preflight, WarnsOfTimesThatAreNotThoseOfSamplesAndMissesNone) {
  RigProfile profile = simulation::default_profile();
  profile.gyro.protocol = "text";
  profile.gyro.text.time = 0;
  const HostTime begin(from_s(1.0));
  for (const int batch : {1, 10}) {
    PreflightWatch watch;
    watch.begin(begin, {}, profile);
    for (int i = 0; i < 1000; ++i) {
      const double read_s = (i / batch + 1) * batch / 200.0;
      TimedGyro gyro;
      gyro.stamp.arrival = begin + from_s(read_s);
      gyro.reading.device_time_us = std::llround(1e6 * read_s);
      watch.gyro(gyro);
    }
    const PreflightReport report = judge(watch.facts(begin + from_s(5.0), {}, profile), profile);
    EXPECT_EQ(report.facts.streams[Device::gyro]->lost_share, 0.0) << batch;
    const auto is_of_times = [](const PreflightViolation& one) { return one.name == "gyro_times"; };
    const auto warning = std::find_if(report.warnings.begin(), report.warnings.end(), is_of_times);
    ASSERT_EQ(warning != report.warnings.end(), batch > 1);
    if (batch == 1) continue;
    EXPECT_THAT(warning->advice, HasSubstr("time_column = -1"));
  }
}

TEST(Preflight, JudgesClocksAndAnswers) {
  PreflightFacts facts;
  facts.streams[Device::servo] =
      PreflightStream{.messages = 300, .rate_hz = 100, .nominal_hz = 100, .uncertainty_s = 0.012};
  facts.answers = PreflightAnswers{.requests = 30, .answered = 20, .round_trip_s = 0.09};
  std::vector<std::string> names;
  for (const PreflightViolation& violation : judge(facts, simulation::default_profile()).violations)
    names.push_back(violation.name);
  EXPECT_THAT(names, ::testing::ElementsAre("servo_clock", "servo_answers", "servo_round_trip"));
}

}  // namespace
}  // namespace thermorig::rig::test
