// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "thermorig/core/time.h"
#include "thermorig/rig/sweep/plan.h"

namespace thermorig::rig {

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

}  // namespace thermorig::rig
