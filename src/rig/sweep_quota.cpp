// SPDX-License-Identifier: MIT
// Legs go on until their speed has its valid frames. Labels come late, so a leg that should have them is
// left, looked at once they are there, and driven once more if they say otherwise.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "thermorig/rig/sweep.h"

namespace thermorig::rig {

namespace {

// Of frames that have no label yet, so many may turn out invalid; and of a leg that goes back and forth, by
// the session's labels, which see the bends of each sweep with better clocks.
constexpr int margin_frames = 1;
constexpr double command_delay_s = 0.25;  // from here to the servo's next command
constexpr double label_patience_s = 3.0;  // a frame waits a second at most for its label
constexpr double patience = 1.5;          // a step may take so many times the frames that it should
constexpr int least_growth = 5;           // and in any case so many times those of the plan
constexpr int fruitless_frames_min = 24;
constexpr int frames_in_flight = 8;  // that have no label yet

}  // namespace

void SweepWalker::sample(const LabelledSample& sample) {
  ++samples_seen_;
  quota_.sample(sample);
  if (sample.valid)
    fruitless_ = 0;
  else if (sample.leg != 0)
    ++fruitless_;
}

/// Camera frames that the leg still needs for its quota, as far as can be foretold.
double SweepWalker::frames_to_quota() const {
  const std::size_t step = to_drive_.front().index;
  return frames_for(quota_.missing(step), expected_[step].course, frames_.rate_hz());
}

/// Frames of this leg that have no label yet, but will be valid. Nobody knows of a servo that turns back.
int SweepWalker::frames_awaited() const {
  if (leg_.turn_back()) return 0;
  const LegCourse& course = expected_[to_drive_.front().index].course;
  const double lost_s = course.ramp_s + window_s(1, servo_, frames_.rate_hz());
  const int lost = static_cast<int>(std::ceil(lost_s * frames_.rate_hz()));
  const int unlabelled = static_cast<int>(frames_seen_ - samples_seen_);
  return std::max(0, std::min(unlabelled, leg_.record().frames - lost)) + leg_.missing();
}

/// Frames at this speed before the servo must brake for its stop.
int SweepWalker::frames_that_fit() const {
  const auto limit_deg = angle_limit_deg(servo_);
  const int unlimited = plan_.frames_per_leg;
  if (!limit_deg || leg_.turn_back() || !last_telemetry_) return unlimited;
  const double speed_dps = std::abs(rate_dps());
  const double direction = rate_dps() < 0.0 ? -1.0 : 1.0;
  const double room_deg = *limit_deg - direction * last_telemetry_->state.angle_deg -
                          speed_dps * speed_dps / (2.0 * servo_.acceleration_dps2);
  const double frames = (room_deg / speed_dps - command_delay_s) * frames_.rate_hz();
  return static_cast<int>(std::clamp(frames - 1.0, 0.0, static_cast<double>(unlimited)));
}

/// The leg has its frames: goes on if they are not valid enough. Says whether it does.
bool SweepWalker::extend_leg(HostTime now) {
  const std::size_t step = to_drive_.front().index;
  const int spare = plan_.valid_per_leg > 0 && leg_.turn_back() ? margin_frames : 0;
  const int missing = quota_.missing(step, spare);
  if (missing == 0 || gives_up(step, leg_.record().frames, now)) return false;
  const int wanted = missing + margin_frames - frames_awaited();
  const int more = std::min(leg_.turn_back() ? 1 : wanted, frames_that_fit());
  if (wanted <= 0 || more <= 0) return false;
  leg_.extend(more);
  return true;
}

/// Frames that a step may have in all its legs.
double SweepWalker::frames_limit(std::size_t step) const {
  const double planned = plan_.frames_per_leg;
  return std::clamp(patience * expected_[step].frames, least_growth * planned, frames_growth_max * planned);
}

/// Is there no sense in driving this step on: too many frames, none of the latest valid, or so few that the
/// quota lies beyond all patience? Says so once. `frames`: of the leg under way.
bool SweepWalker::gives_up(std::size_t step, int frames, HostTime now) {
  if (given_up_[step]) return true;
  const int driven = driven_frames_[step] + frames;
  const int missing = quota_.missing(step);
  const double valid = std::max(0, plan_.valid_per_leg - missing);
  const bool is_hopeless = driven * static_cast<double>(missing) > valid * (frames_limit(step) - driven);
  const bool is_fruitless = fruitless_ >= std::max(plan_.frames_per_leg, fruitless_frames_min);
  const bool is_long_enough = driven >= expected_[step].frames + frames_in_flight;
  if (driven < frames_limit(step) && !is_fruitless && !(is_hopeless && is_long_enough)) return false;
  given_up_[step] = true;
  event(now, EventKind::warning,
        fmt::format("step {} of {} ({:+g} deg/s): still {} valid frames short after {} frames; going on "
                    "without them",
                    step + 1, plan_.leg_rates_dps.size(), plan_.leg_rates_dps[step], missing, driven));
  return true;
}

/// The step's leg is left or ended; whether it has its quota is seen when its frames have their labels.
void SweepWalker::finish_step(HostTime now) {
  const std::uint64_t last_frame = frames_seen_ + static_cast<std::uint64_t>(std::max(0, leg_.missing()));
  if (plan_.valid_per_leg > 0) open_steps_.push_back({to_drive_.front().index, last_frame, now});
  to_drive_.pop_front();
}

void SweepWalker::judge_open_steps(HostTime now) {
  while (!open_steps_.empty()) {
    const OpenStep open = open_steps_.front();
    const bool labelled = samples_seen_ >= open.last_frame || to_s(now - open.left) > label_patience_s;
    if (!labelled) return;
    open_steps_.pop_front();
    const bool comes_again = std::any_of(to_drive_.begin(), to_drive_.end(),
                                         [&](const Step& step) { return step.index == open.step; });
    if (quota_.missing(open.step) == 0 || comes_again || gives_up(open.step, 0, now)) continue;
    drive_again({.index = open.step}, now);
  }
}

/// After the leg that has begun meanwhile.
void SweepWalker::drive_again(const Step& step, HostTime now) {
  to_drive_.insert(to_drive_.empty() ? to_drive_.end() : to_drive_.begin() + 1, step);
  note_repeat(step.index, now);
}

}  // namespace thermorig::rig
