// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "thermorig/core/error.h"
#include "thermorig/core/profile.h"
#include "thermorig/core/raw_recording.h"
#include "thermorig/core/sample.h"
#include "thermorig/core/time.h"
#include "thermorig/rig/driven_leg.h"
#include "thermorig/rig/frame_schedule.h"
#include "thermorig/rig/plan.h"
#include "thermorig/rig/quota.h"
#include "thermorig/rig/servo_commander.h"
#include "thermorig/rig/yield.h"

namespace thermorig::rig {

enum class SweepPhase : std::uint8_t {
  waiting,   // start() has not been called
  greeting,  // hello, configure, arm
  opening_rest,
  transit,  // to where the next leg starts
  leg,
  recovering,  // after a fault or reset: at rest, then armed again
  awaiting,    // at rest until a device that went is back
  closing_rest,
  halting,   // to rest and disarmed at the end of the plan
  stopping,  // on request
  done,
};
std::string name_of(SweepPhase phase);

/// Where the sweep stands: for the progress line.
struct SweepProgress {
  SweepPhase phase = SweepPhase::waiting;
  int leg = 0;  // of the plan, counted from 1; 0 before the first
  int leg_count = 0;
  double rate_dps = 0.0;                // commanded in this leg
  std::optional<double> next_rate_dps;  // of the leg after this one
  int frames = 0;                       // in this leg so far
  int frames_per_leg = 0;
  double done_share = 0.0;         // 0..1
  double eta_s = 0.0;              // from the plan, not from the elapsed time
  int repeated = 0;                // legs that had to be driven again
  int valid = 0;                   // valid frames so far at this speed, in its direction
  int valid_quota = 0;             // of so many; 0: no quota
  std::vector<SpeedQuota> speeds;  // of the whole plan, ascending
};

/// What interrupted the sweep, and how often.
struct SweepTrouble {
  std::string what;  // "the servo's watchdog tripped"
  std::string advice;
  int count = 0;
};

/// Drives the servo through a plan: rest, legs (with a transit where a leg does not fit from here), rest.
/// A leg goes on until its speed has its valid frames; one that a fault cut short, or that lacks a frame or
/// valid ones, is driven again under a new number. Pure: fed with frames, their labels and telemetry, it puts
/// commands into the commander's queue.
class SweepWalker {
 public:
  SweepWalker(const SweepPlan& plan, const ServoProfile& servo, double nominal_frame_rate_hz,
              ServoCommander& commander);

  void greet();              // hello and configure, so that the servo is known to be there
  void start(HostTime now);  // all devices send: the opening rest begins
  void frame(const TimedFrame& frame);
  void telemetry(const TimedServo& servo);
  void sample(const LabelledSample& sample);  // of each frame, in order, some time after it

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
  bool suspended() const { return phase_ == SweepPhase::awaiting; }

  bool done() const { return phase_ == SweepPhase::done; }
  bool plan_complete() const { return plan_complete_; }
  bool confirmed_at_rest() const { return at_rest_; }  // at the end
  SweepPhase phase() const { return phase_; }
  SweepProgress progress(HostTime now) const;
  const std::vector<SweepTrouble>& troubles() const { return troubles_; }  // so far, each kind once

  // What happened since the last call.
  std::vector<RecordingEvent> take_events();
  std::vector<LegRecord> take_legs();

 private:
  /// A step of the plan that is still to be driven.
  struct Step {
    std::size_t index = 0;
    bool was_short = false;  // its last frame did not come in time: this time it is waited for
  };

  /// A step that was driven, but whose last frames have no labels yet.
  struct OpenStep {
    std::size_t step = 0;
    std::uint64_t last_frame = 0;  // number of samples with which all are there
    HostTime left{};
  };

  void enter(SweepPhase phase, HostTime now);
  void next_leg(HostTime now);
  void give_up_steps(HostTime now);
  void fill_steps();
  void begin_leg(HostTime now);
  void send_run(HostTime now);
  void note_leg_start(HostTime acknowledged);
  bool servo_is_heard(HostTime now) const;
  bool has_its_frames(HostTime now) const;
  bool is_between_frames(HostTime now) const;
  void leave_leg(HostTime now);
  void write_down(const DrivenLeg& leg, HostTime now);
  void frame_of_left_leg(HostTime middle, HostTime arrival, HostDuration doubt);
  void settle_left_leg(HostTime now);
  double frames_to_quota() const;
  int frames_awaited() const;
  int frames_that_fit() const;
  bool extend_leg(HostTime now);
  double frames_limit(std::size_t step) const;
  bool gives_up(std::size_t step, int frames, HostTime now);
  void finish_step(HostTime now);
  void judge_open_steps(HostTime now);
  void drive_again(const Step& step, HostTime now);
  void note_repeat(std::size_t step, HostTime now);
  void halt(HostTime now);
  void trouble(HostTime now, const std::string& what, ServoFault fault = ServoFault::none);
  void count_trouble(const std::string& what, const std::string& advice);
  void write_down_cut_leg(HostTime now);
  void repeat_cut_leg(HostTime now);
  void tick_greeting(HostTime now);
  void tick_transit(HostTime now);
  void tick_leg(HostTime now);
  void tick_closing_rest(HostTime now);
  void tick_recovering(HostTime now);
  void resume(HostTime now);
  void tick_halting(HostTime now);
  void tick_stopping(HostTime now);
  bool watch_for_trouble(HostTime now);
  void event(HostTime now, EventKind kind, std::string message);
  bool servo_at_rest() const;
  bool is_faulty() const;
  bool servo_is_disarmed() const;
  bool drives() const;
  double leg_duration_s(double frames) const;
  double travel_deg() const;
  double start_angle_deg() const;
  bool fits_from_here() const;
  double arm_angle_deg() const;
  double recovery_rest_s() const;
  double remaining_s(HostTime now) const;
  double rate_dps() const;  // of the current step
  std::optional<double> next_rate_dps() const;
  int step_number() const;  // of the plan, counted from 1

  SweepPlan plan_;
  ServoProfile servo_;
  FrameSchedule frames_;
  ServoCommander& commander_;
  SweepPhase phase_ = SweepPhase::waiting;
  HostTime phase_begin_{};
  std::deque<Step> to_drive_;  // the first one is under way
  std::uint16_t last_number_ = 0;
  ValidQuota quota_;
  std::vector<ExpectedLeg> expected_;  // by step
  std::vector<int> driven_frames_;     // by step, of the legs that have ended
  std::vector<bool> given_up_;         // by step: its quota is out of reach
  std::deque<OpenStep> open_steps_;
  std::uint64_t frames_seen_ = 0;
  std::uint64_t samples_seen_ = 0;
  int fruitless_ = 0;             // frames of legs since the last valid one
  int failures_ = 0;              // of this step, in a row
  int interruptions_ = 0;         // by devices that went, since a leg was driven to its end
  double shortest_rest_s_ = 0.0;  // of recovering
  int repeated_ = 0;
  DrivenLeg leg_;
  HostTime run_ends_{};                // of the RUN command that was sent last
  std::optional<DrivenLeg> left_leg_;  // its last frame is still on its way
  int frames_since_left_ = 0;
  bool last_is_late_ = false;  // what was counted as its last frame may be the one after
  double transit_target_deg_ = 0.0;
  HostTime transit_limit_{};
  std::optional<TimedServo> last_telemetry_;
  int stop_tries_ = 0;
  bool disarm_sent_ = false;
  bool rearm_sent_ = false;
  HostTime armed_since_{};
  SweepPhase resume_ = SweepPhase::leg;     // after recovering
  std::optional<double> driven_angle_deg_;  // commanded last while it was armed
  bool plan_complete_ = false;
  bool at_rest_ = false;
  std::vector<SweepTrouble> troubles_;
  std::vector<RecordingEvent> events_;
  std::vector<LegRecord> legs_;
};

}  // namespace thermorig::rig
