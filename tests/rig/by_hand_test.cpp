// SPDX-License-Identifier: MIT
// A rig without a servo: turned by hand, its labels are the gyro's.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "simulated_bus.h"
#include "thermorig/rig/recording/finalise.h"
#include "thermorig/rig/recording/recording.h"
#include "thermorig/storage/journal/journal.h"

namespace thermorig::rig::test {
namespace by_hand {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// Somebody turns it by 400 degrees and back; without a rest before, if they begin at once.
simulation::VirtualRigConfig turned_rig(double begin_s = 10.0) {
  simulation::VirtualRigConfig config = simulation::default_rig(3, "kitchen");
  config.hand_turns = {{config.start + from_s(begin_s), 8.0, 400.0},
                       {config.start + from_s(begin_s + 8.0), 5.0, -400.0}};
  return config;
}

RigProfile without_servo() {
  RigProfile profile = simulation::default_profile();
  profile.servo.kind = ServoKind::none;
  return profile;
}

/// The servo of the simulated rig is not connected.
struct HandBus : SimulatedBus {
  explicit HandBus(const simulation::VirtualRigConfig& config) : SimulatedBus(config) {
    is_cut = [](Device device, HostTime) { return device == Device::servo; };
  }
};

VirtualOptions options_in(const TemporaryFolder& folder, double seconds) {
  VirtualOptions options;
  options.recording = recording_options(folder, without_servo(), by_hand_plan(seconds));
  return options;
}

/// Of the valid labels against the true speed.
struct LabelErrors {
  double root_mean_square_dps = 0.0;
  std::size_t valid = 0;
};

LabelErrors errors_of(const session::Session& session, const simulation::VirtualRig& rig) {
  std::map<std::uint64_t, double> true_dps;
  for (const simulation::SentMessage& sent : rig.sent_frames())
    true_dps[sent.span.begin] = sent.mean_rate_dps;
  LabelErrors errors;
  double squares = 0.0;
  for (std::size_t i = 0; i < session.samples.size(); ++i) {
    if (!session.samples[i].valid) continue;
    const auto truth = true_dps.find(session.frames[i].span.begin);
    if (truth == true_dps.end()) continue;
    const double off_dps = static_cast<double>(session.samples[i].rate_shaft_dps) - truth->second;
    squares += off_dps * off_dps;
    ++errors.valid;
  }
  errors.root_mean_square_dps = std::sqrt(squares / static_cast<double>(errors.valid));
  return errors;
}

TEST(ByHand, HasLabelsOfTheGyroThatAreTheTrueSpeed) {
  const TemporaryFolder folder;
  HandBus bus(turned_rig());
  bus.rig.keep_truth(true);
  const RecordingResult result = record_virtual(bus, options_in(folder, 31.0));
  EXPECT_EQ(result.exit, ExitCode::ok) << result.message;
  EXPECT_EQ(result.quality.verdict, "good");
  EXPECT_THAT(result.lacking, IsEmpty());
  const session::Session session = session::read_session(result.session);
  EXPECT_EQ(session.state, session::State::complete);
  EXPECT_EQ(session.raw.header.profile.servo.kind, ServoKind::none);
  const LabelErrors errors = errors_of(session, bus.rig);
  EXPECT_GT(errors.valid, session.samples.size() * 9 / 10);
  EXPECT_LT(errors.root_mean_square_dps, 1.0);
  for (const LabelledSample& sample : session.samples) {
    EXPECT_TRUE(std::isnan(sample.rate_commanded_dps));  // nothing was
    EXPECT_EQ(sample.leg, 0);
  }
}

TEST(ByHand, RefusesLabelsWhereNoRestTellsTheBias) {
  const TemporaryFolder folder;
  HandBus bus(turned_rig(0.2));
  const RecordingResult result = record_virtual(bus, options_in(folder, 16.0));
  EXPECT_EQ(result.exit, ExitCode::finished_lossy);
  EXPECT_EQ(result.quality.verdict, "bad");
  EXPECT_THAT(result.quality.verdict_reasons, Contains(HasSubstr("leave the rig alone for the first 10 s")));
  EXPECT_THAT(result.lacking, Contains(HasSubstr("a rest of 10 s at the beginning")));
  const session::Session session = session::read_session(result.session);
  for (const LabelledSample& sample : session.samples) {
    EXPECT_FALSE(sample.valid);
    EXPECT_TRUE(std::isnan(sample.rate_shaft_dps));
    EXPECT_NE(sample.reason_bits & bit(Reason::no_bias), 0U);
  }
}

TEST(ByHand, SaysWhatTheTurnsDidNotShow) {
  const TemporaryFolder folder;
  simulation::VirtualRigConfig config = turned_rig();
  config.hand_turns = {{config.start + from_s(8.0), 4.0, 200.0}};
  HandBus bus(config);
  const RecordingResult result = record_virtual(bus, options_in(folder, 11.0));
  EXPECT_THAT(result.lacking,
              testing::ElementsAre(HasSubstr("a rest of 5 s at the end"), HasSubstr("a whole turn"),
                                   HasSubstr("the other way (negative rates)")));
}

/// Ctrl-C is how it ends where nobody says how long it lasts; a journal that a crash left gives the same.
TEST(ByHand, IsWholeWhenItIsStoppedAndIsRecovered) {
  const TemporaryFolder folder;
  HandBus bus(turned_rig(8.0));
  RecordingOptions options = recording_options(folder, without_servo(), by_hand_plan({}));
  const DrivenRun run = run_to_journal(bus, options, {.stop_at_s = 24.0});
  const session::Session session = build_session(run.raw);
  EXPECT_EQ(session.state, session::State::complete);
  EXPECT_EQ(session::quality_of(session).verdict, "good");
  HandBus other(turned_rig(8.0));
  const TemporaryFolder another;
  options.output = another.path();
  const DrivenRun killed = run_to_journal(other, options, {.give_up_at_s = 24.0});
  const session::Session recovered = build_session(journal::read_journal(killed.file.journal).recording);
  EXPECT_EQ(recovered.state, session::State::recovered);
  EXPECT_GT(session::quality_of(recovered).valid, 150U);
}

/// What is left of the rig is shown: camera alone, gyro alone.
TEST(ByHand, GoesOnWithAnyDeviceThatIsThere) {
  for (const Device only : {Device::camera, Device::gyro}) {
    SCOPED_TRACE(name_of(only));
    const TemporaryFolder folder;
    SimulatedBus bus(turned_rig());
    bus.is_cut = [only](Device device, HostTime) { return device != only; };
    VirtualOptions options = options_in(folder, 12.0);
    options.recording.needed = {{false, false, true}};
    options.recording.keep = false;
    int frames = 0;
    options.recording.observe = [&](const Measurement&, HostTime) {
      ++frames;
      return std::optional<EstimateRow>();
    };
    const RecordingResult result = record_virtual(bus, options);
    EXPECT_EQ(result.exit, ExitCode::finished_lossy);
    EXPECT_THAT(result.message,
                HasSubstr(only == Device::camera ? "without the gyro" : "without the camera"));
    EXPECT_GT(frames, 30);
  }
}

}  // namespace by_hand
}  // namespace thermorig::rig::test
