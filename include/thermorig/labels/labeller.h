// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "thermorig/core/sample.h"
#include "thermorig/core/time.h"
#include "thermorig/labels/command_track.h"
#include "thermorig/labels/gyro_track.h"

namespace thermorig::labels {

struct LabelConfig {
  double settle_s = 0.2;            // constant speed needed before the exposure, for the servo to follow
  double rate_tolerance_dps = 0.5;  // "constant": the commanded speed varies by no more than this
  double telemetry_gap_s = 0.05;    // a longer hole in telemetry is a loss
  double gyro_gap_share = 0.5;      // fewer than this share of the expected gyro samples is a gap
  double gyro_rate_hz = 200.0;
  double wait_s = 1.0;      // a frame waits so long for late telemetry and gyro, then goes without
  double history_s = 10.0;  // telemetry and gyro samples are kept so long
  double stop_margin_deg = 2.0;
  double travel_deg = 2160.0;  // 0 for a continuous servo: no stops
};

/// Merges frames, gyro samples and servo telemetry in time order and gives each frame its label, and every
/// reason not to trust it. Frames leave in the order in which they came, each exactly once.
///
/// The commanded speed and angle run straight between telemetry messages at their stamped times. Over
/// E = [exposure_begin, exposure_end]:
///   rate_label             exact mean of the commanded speed; NaN (min, max and uncertainty as well) where E
///                          is not covered: no telemetry at or before its begin or at or after its end, or
///                          more than telemetry_gap_s, by the servo's clock, between two messages
///                          in it or around it
///   rate_label_min, _max   of the commanded speed
///   time                   exposure_end minus a quarter of E: the middle of the newest half
///   angle_label            commanded angle at `time`
///   rate_gyro, gyro_count  of the gyro samples with exposure_begin <= time < exposure_end
///   label_uncertainty      one standard deviation: hypot(s * |a|, q), with s = hypot(the frame's time
///                          uncertainty, the widest of the telemetry's), a = the change of the commanded
///                          speed over E divided by E's length (how fast the mean changes when E is moved)
///                          and q = 0.01 deg/s / sqrt(12), the telemetry's resolution
///   leg                    reported by the last telemetry at or before `time`, with no gap behind it
///
/// Reasons, with S = [exposure_begin - settle_s, exposure_end]:
///   camera_gap        TimedFrame::missing_before is not 0
///   camera_not_fresh  TimedFrame::stale
///   sync_lost         TimedFrame::late
///   checksum          TimedFrame::resync_before
///   out_of_range      a pixel below -60 or above 400 degC, or not a number
///   servo_ramp        the commanded speed varies by more than rate_tolerance_dps over S
///   servo_lost        S is not covered (as above), or telemetry in S or next to it says disarmed or fault
///   limit_hit         the commanded angle comes closer than stop_margin_deg to either end of the travel in
///   E;
///                     angle 0 is its middle
///   reversal          the commanded speed has both signs in E
///   outside_leg       leg 0 in the telemetry in E or next to it, or no leg known
///   leg_change        two legs in the telemetry in E or next to it, neither of them 0
///   gyro_gap          no gyro sample in E, or fewer than gyro_gap_share of what gyro_rate_hz gives in E
/// A frame is valid if it has no reason outside `warning_bits`. A run is unbroken by invalid frames and lies
/// in one leg; a frame lost on the way makes the next one invalid, and so ends the run.
class Labeller {
 public:
  explicit Labeller(LabelConfig config);

  void add(const TimedFrame& frame);  // all its members must be filled in
  void add(const TimedGyro& gyro) { gyro_.add(gyro); }
  void add(const TimedServo& servo) { command_.add(servo); }

  /// Frames whose telemetry and gyro samples are all there, or which have waited too long at host time `now`.
  std::vector<LabelledSample> take(HostTime now);

  /// The stream has ended: everything that still waits.
  std::vector<LabelledSample> finish();

 private:
  struct PendingFrame {
    std::uint32_t index = 0;
    Stamp stamp;
    HostTime exposure_begin{};
    HostTime exposure_end{};
    std::uint32_t reason_bits = 0;  // those that the frame alone tells
  };
  static std::uint32_t frame_reasons(const TimedFrame& frame);
  bool has_all(const PendingFrame& frame) const;
  LabelledSample label(const PendingFrame& frame);
  void label_command(LabelledSample& sample, float frame_uncertainty_s) const;
  void label_gyro(LabelledSample& sample) const;
  std::uint32_t exposure_reasons(const CommandSpan& exposure) const;
  std::uint32_t settle_reasons(const CommandSpan& settled) const;
  void number_run(LabelledSample& sample);

  LabelConfig config_;
  CommandTrack command_;
  GyroTrack gyro_;
  std::deque<PendingFrame> pending_;
  std::uint32_t frame_count_ = 0;
  std::uint32_t run_ = 0;      // number of the newest run
  std::uint16_t run_leg_ = 0;  // its leg, 0 if it has ended
};

}  // namespace thermorig::labels
