// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "thermorig/core/sample.h"
#include "thermorig/core/time.h"
#include "thermorig/pipeline/labels/command_track.h"
#include "thermorig/pipeline/labels/gyro_track.h"
#include "thermorig/pipeline/labels/label_config.h"
#include "thermorig/pipeline/labels/measured_track.h"
#include "thermorig/pipeline/labels/running_bias.h"
#include "thermorig/pipeline/labels/shaft_track.h"
#include "thermorig/pipeline/labels/warm_up.h"

namespace thermorig::labels {

/// Merges frames, gyro samples and servo telemetry in time order and gives each frame its label, and every
/// reason not to trust it. Frames leave in the order in which they came, each exactly once.
///
/// Three witnesses speak about a span of time:
///   commanded  what telemetry says: its speed and angle run straight between messages at their stamped times
///   model      the shaft as the servo's response makes it follow the pulses (ShaftTrack)
///   gyro       the samples with begin <= time < end
/// Over E = [exposure_begin, exposure_end], and over each half's own exposure for the *_half members:
///   rate_commanded         where the commanded speed is constant over E: CommandTrack::constant_rate_dps;
///                          else the exact mean of the commanded speed
///   rate_corrected         rate_commanded times scale and gain of the travel that the model passes in E,
///                          plus what the gyro saw beyond the model at that speed; rate_commanded where no
///                          response was fitted
///   rate_shaft             (model angle at the end of E - that at its begin) / length of E
///   rate_shaft_min, _max   of the model's running mean over one pulse period (20 ms) in E, and of rate_shaft
///                          all NaN where E is not covered: no telemetry at or before its begin or at or
///                          after its end, or more than telemetry_gap_s, by the servo's clock, between two
///                          messages in it or around it
///   time                   exposure_end minus a quarter of E: the middle of the newest half
///   angle_commanded            commanded angle at `time`
///   rate_gyro, gyro_count  mean of the gyro, bias and scale left as they are
///   gyro_spread            standard deviation of the gyro's running mean over 20 ms
///   rate_shaft_uncertainty      one standard deviation, root of the sum of squares of
///                          time: the largest change of rate_shaft when E is moved by half or all of t, where
///                          t^2 = clock^2 + latency^2 + delay^2 + telemetry's clock^2, in seconds;
///                          scale: |rate_shaft| times the response's relative uncertainty;
///                          model: residual that the response's fit left at that speed, or what is assumed
///   rate_commanded_uncertainty, rate_corrected_uncertainty   how far either may be from the true speed: its
///                          distance from the model, with the residual of that speed added to it, and time,
///                          scale and spread of that residual; NaN where rate_shaft is
///   angle_measured             by the readings of the shaft around `time` (MeasuredTrack)
///   rate_measured          (measured angle at the end of E - that at its begin) / length of E; with
///                          rate_measured_uncertainty, which holds the noise of the readings, by how much the
///                          shaft strays from an even motion there, what of its errors repeats with each
///                          turn, and time; NaN where it is not measured, or LabelConfig::by_sensor is false.
///                          Where it is known, rate_shaft, its halves and its uncertainty are these, the
///                          uncertainties of the other two hold their distance from it, and gyro_disagrees
///                          holds the gyro against it
///   leg                    reported by the last telemetry at or before `time`, with no gap behind it
///
/// Reasons, with S = [exposure_begin - settling time, exposure_end] and L = E earlier by the response's delay
/// and one pulse period, which is how old a command is when the shaft shows it:
///   camera_gap           TimedFrame::missing_before is not 0, or half_lost: a warning, which ends the run
///   camera_not_fresh     TimedFrame::stale, but not half_lost
///   sync_lost            TimedFrame::late, or the frame's clock less certain than clock_limit_s
///   checksum             TimedFrame::resync_before
///   out_of_range         a pixel below -60 or above 400 degC, or not a number
///   warm_up              WarmUp: a warning, unless warm_up_invalidates
///                        (neither of these two for a frame that stands in for one of a missing camera)
///   servo_ramp           the model's slow mean (100 ms) leaves rate_commanded by more than tolerance =
///                        max(rate_tolerance_dps, rate_tolerance_share * |rate_commanded|) within E, both
///                        with scale and gain and without; or E is not covered
///   servo_lost           S is not covered (as above), or telemetry in S or next to it says disarmed or fault
///   telemetry_disagrees  TelemetryCheck objects to a message in S or next to it
///   limit_hit            the commanded angle comes closer than stop_margin_deg to either end of the
///                        travel in E; angle 0 is its middle
///   reversal             the model's slow mean has both signs in E, and leaves rate_tolerance_dps both ways
///   outside_leg          leg 0 in the telemetry in L or next to it, or no leg known
///   leg_change           two legs in the telemetry in L or next to it, neither of them 0
///   gyro_gap             no gyro sample in E, or fewer than gyro_gap_share of what gyro_rate_hz gives in E,
///   or
///                        one that would lie in E never came (lacks_sample(), where a first pass found gaps)
///   gyro_unsteady        gyro_spread exceeds the tolerance beyond what noise explains, that of gears
///   included
///                        squared: a warning, and how far each label is from the corrected gyro's mean is
///                        part of its uncertainty; not judged where a sample is saturated
///   gyro_disagrees       |mean gyro, corrected - rate_shaft as the gyro sees it| exceeds 3 standard
///                        deviations (see label_terms.h), gyro_spread of an unsteady one among them; not
///                        judged where a sample is saturated; or the shaft was seen not to reach the
///                        commanded speed (ServoResponse::AtSpeed)
/// Without a servo (LabelConfig::by_gyro) there is one witness. rate_shaft is the gyro's mean over E, less
/// its bias at `time`, over its scale; rate_shaft_min and _max of its running mean over 20 ms; of commanded
/// speeds nothing is known. rate_shaft_uncertainty holds bias, scale, noise and time. Of the reasons only
/// those of the frame itself are there, and
///   no_bias              no rest tells the bias; nothing has a label then
///   gyro_gap             as above, or a sample is saturated
///   reversal             the running mean leaves rate_tolerance_dps both ways
///
/// A frame is valid if it has no reason outside `warning_bits`. A run is unbroken by invalid frames and lies
/// in one leg; a frame or a half lost on the way ends it.
class Labeller {
 public:
  explicit Labeller(const LabelConfig& config);

  void add(const TimedFrame& frame);  // all its members must be filled in
  void add(const TimedGyro& gyro) { gyro_.add(gyro); }
  void add(const TimedServo& servo);
  void add(const TimedShaft& shaft) { measured_.add(shaft); }

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
    HostTime shown_since{};  // exposure_begin, or that of an older half that it still shows
    std::array<HalfExposure, 2> half{};
    std::uint32_t reason_bits = 0;  // those that the frame alone tells
  };
  struct Rates {
    double commanded_dps;
    double corrected_dps;
    double model_dps;
  };
  struct Half {
    HalfExposure exposure;
    Rates mean;
    double gyro_dps;
    double measured_dps;
  };
  std::uint32_t frame_reasons(const TimedFrame& frame);
  bool has_all_until(HostTime end) const;
  LabelledSample label(const PendingFrame& frame);
  void label_motion(LabelledSample& sample, const PendingFrame& frame);
  void label_halves(LabelledSample& sample, const PendingFrame& frame);
  double measured_time_error_dps(HostTime begin, HostTime end, double time_s) const;
  void label_measured(LabelledSample& sample, const PendingFrame& frame);
  GyroMean note_gyro(LabelledSample& sample) const;
  void label_by_gyro(LabelledSample& sample, const PendingFrame& frame);
  void label_gyro(LabelledSample& sample);
  Rates rates(HostTime begin, HostTime end) const;
  double gain(HostTime begin, HostTime end) const;
  double time_error_dps(const LabelledSample& sample, double time_s) const;
  double tolerance_dps(const LabelledSample& sample) const;
  std::uint32_t command_reasons(const LabelledSample& sample) const;
  std::uint32_t model_reasons(const LabelledSample& sample, const ShaftRates& shaft) const;
  double between_samples_s() const;
  bool has_gyro_gap(const LabelledSample& sample, const GyroMean& gyro) const;
  std::uint32_t gyro_reasons(const LabelledSample& sample, const GyroMean& gyro) const;
  bool gyro_disagrees(const LabelledSample& sample, const GyroMean& gyro, double noise_dps,
                      double spread_dps) const;
  bool gyro_disagrees_with_sensor(const LabelledSample& sample, const GyroMean& gyro, double noise_dps) const;
  void widen(LabelledSample& sample, const GyroMean& gyro) const;
  void learn_bias(const LabelledSample& sample, const GyroMean& gyro);
  void number_run(LabelledSample& sample);

  LabelConfig config_;
  ServoResponse response_;
  HostDuration wait_;
  HostDuration settle_;
  HostDuration lag_;
  CommandTrack command_;
  ShaftTrack shaft_;
  MeasuredTrack measured_;
  GyroTrack gyro_;
  RunningBias bias_;
  MotionNoise motion_noise_;
  WarmUp warm_up_;
  std::deque<PendingFrame> pending_;
  std::array<std::optional<Half>, 2> halves_;  // as labelled last
  std::uint32_t frame_count_ = 0;
  std::uint32_t run_ = 0;                 // number of the newest run
  std::optional<std::uint16_t> run_leg_;  // its leg; none: it has ended
};

}  // namespace thermorig::labels
