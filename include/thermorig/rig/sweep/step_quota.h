// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "thermorig/rig/sweep/driven_leg.h"
#include "thermorig/rig/sweep/quota.h"
#include "thermorig/rig/sweep/yield.h"

namespace thermorig::rig {

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
