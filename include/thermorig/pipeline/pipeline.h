// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "thermorig/core/device.h"
#include "thermorig/core/measurement.h"
#include "thermorig/core/profile.h"
#include "thermorig/core/sample.h"
#include "thermorig/core/sync.h"
#include "thermorig/core/time.h"
#include "thermorig/pipeline/labels/exposure.h"
#include "thermorig/pipeline/labels/frame_gaps.h"
#include "thermorig/pipeline/labels/labeller.h"
#include "thermorig/sensors/wire/counters.h"
#include "thermorig/sensors/wire/servo_messages.h"

namespace thermorig::pipeline {

/// What a first pass over a recording learns for the second. Live, nothing is known: clocks are causal, the
/// period is nominal, and the mode is the one that most of the frames so far show.
struct Fits {
  std::optional<labels::CameraMode> camera_mode;
  std::optional<unsigned> newer_half;    // full-fresh: the chess half that is exposed last, 0 even, 1 odd
  std::optional<double> frame_period_s;  // time between frames
  std::vector<labels::FrameGap> gaps;    // before each frame, in order
  PerDevice<std::vector<TimeEstimate>> times;  // of each frame, gyro sample and telemetry message, in order
  double servo_rate_scale = 1.0;               // true speeds of a servo for each that it states
  std::optional<SyncReport> sync;
};

/// Exposures by what a first pass found, else by the profile.
labels::ExposureRule exposure_rule(const CameraProfile& profile, const Fits& fits);

/// Everything that came out of the bytes, at the moment at which it came, in arrival order: for those who
/// watch the devices, and for a first pass. What belongs together comes later, as measurements.
struct Streams {
  std::vector<TimedFrame> frames;
  std::vector<TimedFrame> stand_ins;  // made since: see stand_in_for_camera()
  std::vector<TimedGyro> gyro;
  std::vector<TimedServo> servo;
  std::vector<TimedShaft> shaft;  // of a shaft that is measured; else empty
  std::vector<TimedPong> pongs;
  std::vector<wire::ServoMessage>
      servo_answers;                     // welcome, ack, nack, event: what the rig's servo link needs
  std::vector<ClockEpoch> servo_epochs;  // of the servo's clock, begun since: a reset, a wrong baud, ...
};

/// The flow of the whole program: bytes -> messages -> timed samples -> labelled measurements.
/// Recording, finalising, replay and live are this one object, fed from different places.
/// Pure: it opens nothing, starts nothing, reads no clock.
class Pipeline {
 public:
  /// `without_labels`: for a first pass, which looks at the streams alone. No call returns a measurement.
  explicit Pipeline(const RigProfile& profile, const Fits& fits = {}, bool without_labels = false);
  ~Pipeline();
  Pipeline(Pipeline&&) noexcept;
  Pipeline& operator=(Pipeline&&) noexcept;

  /// A hint: so many bytes of each device will come. Room for their messages is made once, instead of again
  /// and again while the streams grow.
  void expect(const PerDevice<std::uint64_t>& bytes);

  /// One chunk of bytes in, zero or more measurements out. The caller brings the time, which should not run
  /// backwards from one call to the next, whichever device it is for. Every camera frame gives exactly one
  /// measurement, here or in finish(), in the order of the frames.
  std::vector<Measurement> feed(Device from, std::span<const std::uint8_t> chunk, HostTime arrived);

  /// Bytes that were written to a device, and the time before write(), in order of time with feed(). Those to
  /// the servo are one side of its clock.
  void sent(Device to, std::span<const std::uint8_t> bytes, HostTime before_write);

  /// The device went away: pulled out, silent, or sending what nobody can read. What comes from it later is
  /// of a clock anew, and nothing reaches over the gap. Returns the measurements that this completes.
  std::vector<Measurement> interrupt(Device device, HostTime now);

  /// The camera is missing since then, and nobody waits for it: a frame without an image takes the place of
  /// each that would have come. Once the first has, the camera's own are in the streams only.
  void stand_in_for_camera(HostTime since);
  bool stands_in_for_camera() const;  // the first of these frames has come

  /// No more bytes will come: the measurements that still wait for telemetry or gyro.
  std::vector<Measurement> finish();

  /// What was decoded since the last call. Live callers take it after each feed.
  Streams take_streams();

  const wire::Counters& counters(Device device) const;

 private:
  struct Stages;
  std::unique_ptr<Stages> stages_;
};

}  // namespace thermorig::pipeline
