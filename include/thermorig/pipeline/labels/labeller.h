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
/// Three witnesses speak about an exposure: telemetry says what was commanded (CommandTrack), the servo's
/// response how the shaft followed the pulses (ShaftTrack), the gyro how it turned (GyroTrack); where a
/// sensor on the shaft is believed, MeasuredTrack says what the shaft did. Without a servo
/// (LabelConfig::by_gyro) there is the gyro alone. What each column is and each reason rests on:
/// docs/recording_format.md, "Labels" and "Validity".
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
