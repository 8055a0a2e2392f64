// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "thermorig/core/sample.h"
#include "thermorig/core/time.h"
#include "thermorig/rig/sweep/driven_leg.h"
#include "thermorig/rig/sweep/plan.h"

namespace thermorig::rig {

/// Valid frames that one commanded speed has, of those that it needs. Signed.
struct SpeedQuota {
  double rate_dps = 0.0;
  int valid = 0;
  int wanted = 0;
  bool is_short() const;
};

/// A recording drives by labels that are made at once; those of its session, which know all of it, may find
/// so many frames fewer valid before a speed counts as short.
inline constexpr int quota_tolerance_frames = 2;

/// Counts valid frames by the speed and the direction that were really commanded: a leg that goes back and
/// forth fills both directions. A plan that drives a speed twice wants twice as many.
class ValidQuota {
 public:
  explicit ValidQuota(const SweepPlan& plan);

  /// A leg with this number has begun, at one of the plan's speeds.
  void leg(std::uint16_t number, double rate_dps);

  void sample(const LabelledSample& sample);

  /// Valid frames that this step of the plan still lacks, 0 if none: with the steps before it at the same
  /// speed it wants its share, and `spare` more.
  int missing(std::size_t step, int spare = 0) const;

  /// Ascending by speed.
  std::vector<SpeedQuota> speeds() const;

 private:
  std::vector<double> step_rates_dps_;
  std::vector<int> wanted_by_step_;       // up to and with each step, at its speed
  std::map<long, SpeedQuota> speeds_;     // by hundredths of deg/s, as the link counts
  std::map<std::uint16_t, double> legs_;  // magnitude by number
};

/// A step of a plan that is still to be driven.
struct Step {
  std::size_t index = 0;
  bool was_short = false;  // its last frame did not come in time: this time it is waited for
};

/// The steps of a plan in the order in which they are driven; and those that are driven already, but may have
/// to be driven again when their last frames have labels.
class StepQueue {
 public:
  explicit StepQueue(const SweepPlan& plan) : plan_(plan) { fill(); }

  void fill();  // all steps, once more
  void clear() { to_drive_.clear(); }
  bool empty() const { return to_drive_.empty(); }

  /// The one under way, or to be driven next. There must be one.
  const Step& front() const { return to_drive_.front(); }
  double rate_dps() const { return empty() ? 0.0 : plan_.leg_rates_dps[front().index]; }
  /// Its number in the plan, from 1; without one that of the last.
  int number() const;
  std::optional<double> rate_dps_at(std::size_t place) const;

  /// After the one under way.
  void drive_again(const Step& step);
  bool is_driven_again(std::size_t step) const;

  /// The front was driven: looked at again where the plan has a quota, once there are so many labels.
  void finish_front(std::uint64_t labels, HostTime now);
  /// The next step to be looked at: its labels are there, or should be. Each once.
  std::optional<std::size_t> take_labelled(std::uint64_t labels, HostTime now);
  bool awaits_labels() const { return !unlabelled_.empty(); }

  /// The plan with nothing but these steps.
  SweepPlan plan_left() const;

 private:
  struct Unlabelled {
    std::size_t step = 0;
    std::uint64_t labels = 0;  // with which all are there
    HostTime left{};
  };

  SweepPlan plan_;
  std::deque<Step> to_drive_;
  std::deque<Unlabelled> unlabelled_;
};

/// The valid frames that each step of a plan still lacks, what they will cost, and when there is no sense in
/// driving for them any longer. Labels come late: it knows how many frames have none yet.
class StepQuota {
 public:
  StepQuota(const SweepPlan& plan, const ServoProfile& servo, double nominal_frame_rate_hz);

  void begin(const LegRecord& leg);
  void ended(const LegRecord& leg);
  void frame() { ++frames_; }
  void sample(const LabelledSample& sample);

  std::uint64_t samples() const { return samples_; }
  /// How many samples there are once all frames of this leg have labels.
  std::uint64_t samples_with(const DrivenLeg& leg) const;
  std::vector<SpeedQuota> speeds() const { return valid_.speeds(); }

  int missing(std::size_t step) const { return valid_.missing(step); }
  /// With what a leg that turns back has to spare.
  int missing(const DrivenLeg& leg) const;

  /// Camera frames that the step still needs, as far as can be foretold.
  double frames_needed(std::size_t step, double frame_rate_hz) const;

  /// Frames that the step's next leg is expected to have.
  double leg_frames(std::size_t step, double frame_rate_hz) const;

  /// Frames that the leg under way should have more than it was to have; 0 or less: none.
  int frames_wanted(const DrivenLeg& leg, double frame_rate_hz) const;

  /// Gives the step up where it has had too many frames, none of the latest valid, or so few that the quota
  /// lies beyond all patience. `frames`: of the leg under way. Says so once.
  std::optional<std::string> give_up(std::size_t step, int frames);
  bool is_given_up(std::size_t step) const { return steps_[step].is_given_up; }

 private:
  struct StepState {
    ExpectedLeg expected;
    int frames = 0;  // of the legs that have ended
    bool is_given_up = false;
  };
  int frames_awaited(const DrivenLeg& leg, double frame_rate_hz) const;
  double frames_limit(const StepState& step) const;

  SweepPlan plan_;
  ServoProfile servo_;
  ValidQuota valid_;
  std::vector<StepState> steps_;
  std::uint64_t frames_ = 0;
  std::uint64_t samples_ = 0;
  int fruitless_ = 0;  // frames of legs since the last valid one
};

}  // namespace thermorig::rig
