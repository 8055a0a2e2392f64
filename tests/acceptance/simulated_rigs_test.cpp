// SPDX-License-Identifier: MIT
// Rigs other than the default one, recorded by the built program: what their sessions say of them.
#include <gmock/gmock.h>

#include <map>

#include "app/program.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::tests {
namespace {

class SimulatedRig : public ProgramTest {
 protected:
  session::Session recorded(const std::string& options) const {
    const Outcome outcome =
        run("record --fast --json --world honest --simulated=2 --environment laboratory --plan quick "
            "--speeds 20,150 --frames-per-leg 24 --valid-per-leg 0 " +
            options);
    EXPECT_EQ(outcome.code, 0) << options << outcome.out << outcome.err;
    return session::read_session(folder() / outcome.lines().back().value("session", ""));
  }

  static std::size_t count(const session::Session& session, Reason reason) {
    return static_cast<std::size_t>(
        std::count_if(session.samples.begin(), session.samples.end(),
                      [&](const LabelledSample& sample) { return (sample.reason_bits & bit(reason)) != 0; }));
  }

  /// Each of the four legs has its frames, and those that are valid carry its speed, one way or the other.
  static void expect_sound_legs(const session::Session& session) {
    ASSERT_EQ(session.raw.legs.size(), 4U);
    std::map<std::uint16_t, int> swept;
    for (const LabelledSample& sample : session.samples) ++swept[sample.leg];
    for (const LegRecord& leg : session.raw.legs) {
      EXPECT_TRUE(leg.complete);
      EXPECT_GE(leg.frames, 24) << leg.leg;
      EXPECT_LE(leg.frames, 26) << leg.leg;
      EXPECT_EQ(leg.frames, swept[leg.leg]) << leg.leg;
    }
    for (const LabelledSample& sample : session.samples) {
      if (!sample.valid) continue;
      const double rate_dps = session.raw.legs.at(sample.leg - 1U).rate_dps;
      EXPECT_NEAR(std::abs(sample.rate_commanded_dps), std::abs(rate_dps),
                  std::max(1.0, 0.02 * std::abs(rate_dps)))
          << sample.frame_index;
      // The servo's own scale is off by about a percent, the gyro's by which it is judged by 3.
      EXPECT_NEAR(sample.rate_shaft_dps, sample.rate_commanded_dps, 1.0 + 0.04 * std::abs(rate_dps))
          << sample.frame_index;
      EXPECT_NEAR(sample.rate_gyro_dps, sample.rate_shaft_dps, 12.0) << sample.frame_index;
    }
  }

  static std::size_t valid_in_slow_legs(const session::Session& session) {
    return static_cast<std::size_t>(
        std::count_if(session.samples.begin(), session.samples.end(), [&](const LabelledSample& sample) {
          return sample.valid && std::abs(session.raw.legs.at(sample.leg - 1U).rate_dps) < 21.0;
        }));
  }
};

/// At 150 deg/s a servo of 180 degrees turns back every 1.2 s.
TEST_F(SimulatedRig, WithLittleTravelGoesBackAndForthAndFlagsItsReversals) {
  for (const char* travel : {"180", "270"}) {
    const session::Session session = recorded(std::string("--simulated-servo ") + travel);
    expect_sound_legs(session);
    EXPECT_EQ(session.raw.header.profile.servo.travel_deg, std::stod(travel));
    EXPECT_GT(count(session, Reason::reversal), 0U);
    for (const LabelledSample& sample : session.samples)
      EXPECT_FALSE(sample.valid && (sample.reason_bits & bit(Reason::reversal)) != 0) << sample.frame_index;
    EXPECT_GT(valid_in_slow_legs(session), 30U);
    for (const TimedServo& servo : session.servo)
      EXPECT_LE(std::abs(servo.state.angle_deg), std::stod(travel) / 2.0) << travel;
  }
}

TEST_F(SimulatedRig, ThatTurnsWithoutEndNeverTurnsBack) {
  const session::Session session = recorded("--simulated-servo continuous");
  expect_sound_legs(session);
  EXPECT_EQ(session.raw.header.profile.servo.kind, ServoKind::continuous);
  EXPECT_EQ(count(session, Reason::limit_hit), 0U);
  for (const LabelledSample& sample : session.samples) {
    if (!sample.valid) continue;
    EXPECT_GT(sample.rate_shaft_dps * session.raw.legs.at(sample.leg - 1U).rate_dps, 0.0)
        << sample.frame_index;
  }
  const auto quality = session::quality_of(session);
  EXPECT_GT(2 * quality.valid, quality.swept);
}

double mean_exposure_s(const session::Session& session) {
  double sum_s = 0.0;
  for (const TimedFrame& frame : session.frames) sum_s += to_s(frame.exposure_end - frame.exposure_begin);
  return sum_s / static_cast<double>(session.frames.size());
}

TEST_F(SimulatedRig, WithFullFreshFramesShowsHalfTheTimeInEachAndHasMoreValidOnes) {
  const session::Session half = recorded("--simulated-camera half");
  const session::Session full = recorded("--simulated-camera full");
  expect_sound_legs(half);
  expect_sound_legs(full);
  EXPECT_EQ(half.camera_mode, "half-fresh");
  EXPECT_EQ(full.camera_mode, "full-fresh");
  EXPECT_NEAR(mean_exposure_s(full) / mean_exposure_s(half), 0.5, 0.01);
  EXPECT_NEAR(half.frame_period_s, 0.125 / 0.98, 0.001);  // its clock is 2 % slow
  EXPECT_GT(session::quality_of(full).valid, session::quality_of(half).valid);
  EXPECT_EQ(count(half, Reason::camera_not_fresh) + count(full, Reason::camera_not_fresh), 0U);
}

}  // namespace
}  // namespace thermorig::tests
