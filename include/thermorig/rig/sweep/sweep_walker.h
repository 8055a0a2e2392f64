// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "thermorig/core/error.h"
#include "thermorig/core/raw_recording.h"
#include "thermorig/core/sample.h"
#include "thermorig/rig/sweep/driven_leg.h"
#include "thermorig/rig/sweep/quota.h"
#include "thermorig/rig/sweep/servo_driver.h"
#include "thermorig/rig/sweep/sweep.h"
#include "thermorig/rig/sweep/sweep_recovery.h"

namespace thermorig::rig {

/// What a sweep has to tell.
struct SweepNews {
  std::vector<RecordingEvent> events;
  std::vector<LegRecord> legs;
  bool is_complete = false;  // the plan was driven to its end, and the servo is at rest
};

/// Drives the servo through a plan: rest, legs (with a transit where a leg does not fit from here), rest.
/// A leg goes on until its speed has its valid frames; one that a fault cut short, or that lacks a frame or
/// valid ones, is driven again under a new number. Without a servo it only waits until the opening rest,
/// which then is the whole recording, is over. Pure: fed with frames, their labels and telemetry, it puts
/// commands into the commander's queue.
class SweepWalker {
 public:
  SweepWalker(const SweepPlan& plan, const ServoProfile& servo, double nominal_frame_rate_hz,
              ServoDriver& commander);

  void start(HostTime now);  // all devices send: the opening rest begins
  void frame(const TimedFrame& frame);
  void telemetry(const TimedServo& servo);
  /// Of each frame, in order, some time after it.
  void sample(const LabelledSample& sample) { quota_.sample(sample); }

  /// Moves on. Call after each batch of frames, telemetry and answers, and every 10 ms or so.
  /// Throws Error(device_lost) when a leg fails too often.
  void tick(HostTime now);

  /// Stop byte, halt, at rest, disarm: then done(). May be called in any phase.
  void request_stop(HostTime now);

  /// A device went: the leg under way is written down as it is, the servo comes to rest, as far as it can be
  /// reached. Throws Error(device_lost) where that happens again and again without a leg between; `why` it
  /// went is part of it.
  void suspend(HostTime now, const Error& why);
  /// All devices are there again: the servo is armed anew if need be, and after a rest the leg that was
  /// interrupted is driven again, under a new number.
  void go_on(HostTime now);

  bool done() const { return phase_ == SweepPhase::done; }
  SweepPhase phase() const { return phase_; }
  SweepProgress progress(HostTime now) const;
  const std::vector<SweepTrouble>& troubles() const { return recovery_.troubles(); }  // each kind once

  SweepNews take_news() { return std::exchange(news_, {}); }  // what happened since the last call

 private:
  struct Transit {
    double target_deg = 0.0;
    HostTime limit{};  // of patience
  };

  bool has_ended() const { return phase_ == SweepPhase::stopping || phase_ == SweepPhase::done; }
  void enter(SweepPhase phase, HostTime now);
  void tick_greeting(HostTime now);
  void tick_transit(HostTime now);
  void tick_leg(HostTime now);
  void tick_closing_rest(HostTime now);
  void tick_recovering(HostTime now);
  void tick_stopping(HostTime now);
  void next_leg(HostTime now);
  void begin_leg(HostTime now);
  void send_run(HostTime now);
  bool extend_leg(HostTime now);
  void leave_leg(HostTime now);
  void settle_left_leg(HostTime now);
  void write_down(const DrivenLeg& leg, HostTime now);
  void write_down_cut_leg(HostTime now);
  void repeat_cut_leg(HostTime now);
  void note_repeat(std::size_t step, HostTime now);
  void judge_driven_steps(HostTime now);
  bool gives_up(std::size_t step, int frames, HostTime now);
  bool watch_for_trouble(HostTime now);
  void trouble(HostTime now, const std::string& what, ServoFault fault = ServoFault::none);
  void event(HostTime now, EventKind kind, std::string message);
  double remaining_s(HostTime now) const;

  SweepPlan plan_;
  ServoProfile servo_;
  ServoDriver& commander_;
  FrameSchedule frames_;
  ServoTelemetry telemetry_;
  StepQueue steps_;
  StepQuota quota_;
  SweepPhase phase_ = SweepPhase::waiting;
  HostTime phase_begin_{};
  double by_hand_s_ = 0.0;  // that was recorded so before a device went
  Transit transit_;
  DrivenLeg leg_;  // the latest: no two have the same number
  std::optional<LeftLeg> left_leg_;
  SweepRecovery recovery_;
  ServoStop stop_;
  int repeated_ = 0;
  SweepNews news_;
};

}  // namespace thermorig::rig
