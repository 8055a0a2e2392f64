// SPDX-License-Identifier: MIT
#include <utility>
#include <vector>

#include "camera_line.h"
#include "camera_rhythm.h"
#include "camera_shift.h"
#include "clock_fits.h"
#include "final_times.h"
#include "message_spans.h"
#include "thermorig/labels/servo_response.h"
#include "thermorig/motion/panorama_fit.h"
#include "thermorig/pipeline/pipeline.h"
#include "thermorig/timing/arrivals.h"

namespace thermorig::pipeline {

namespace {

template <typename Message>
void put_times(const std::vector<TimeEstimate>& times, std::vector<Message>& messages) {
  FinalTimes final_times(times);
  for (Message& message : messages) final_times.put_next(message.stamp);
}

/// The rhythm is counted on what the bytes prove: causal stamps have been made with a count of their own.
void put_proofs(const RawStream& received, std::uint32_t baud, std::vector<TimedFrame>& frames) {
  const std::vector<StreamSpan> spans = spans_of(frames);
  if (!holds(received, spans)) return;
  const auto proofs = timing::earliest_proofs(received, spans, baud);
  for (std::size_t i = 0; i < frames.size(); ++i) frames[i].stamp.time = proofs[i];
}

PerDevice<ClockFit> fit_clocks(const RawRecording& raw, Streams& streams, const CameraRhythm& rhythm) {
  const auto& [camera, gyro, servo] =
      std::tie(raw.header.profile.camera, raw.header.profile.gyro, raw.header.profile.servo);
  PerDevice<ClockFit> clocks;
  clocks[Device::camera] =
      fit_camera_clock(raw.received[Device::camera], streams.frames, rhythm.gaps, camera);
  clocks[Device::gyro] = fit_gyro_clock(raw.received[Device::gyro], streams.gyro, gyro);
  clocks[Device::servo] = fit_servo_clock(raw.received[Device::servo], raw.sent, streams, servo);
  put_times(clocks[Device::camera].times, streams.frames);
  put_times(clocks[Device::gyro].times, streams.gyro);
  put_times(clocks[Device::servo].times, streams.servo);
  return clocks;
}

/// What each frame shows when, by the fits so far.
void expose(std::vector<TimedFrame>& frames, const CameraProfile& profile, const Fits& fits) {
  labels::ExposureRule rule = exposure_rule(profile, fits);
  for (TimedFrame& frame : frames) rule.apply(frame);
}

void fit_newer_half(Streams& streams, const RigProfile& profile, const GyroErrors& errors, Fits& fits) {
  if (fits.camera_mode != labels::CameraMode::full_fresh) return;
  fits.newer_half = motion::newer_half(streams.frames, streams.gyro,
                                       {profile.camera.field_of_view_deg, profile.camera.mirrored}, errors);
  if (fits.newer_half) expose(streams.frames, profile.camera, fits);
}

}  // namespace

Fits fit(const RawRecording& raw, Streams streams) {
  const RigProfile& profile = raw.header.profile;
  put_proofs(raw.received[Device::camera], profile.camera.link.baud, streams.frames);
  CameraRhythm rhythm = camera_rhythm(streams.frames);
  PerDevice<ClockFit> clocks = fit_clocks(raw, streams, rhythm);
  Fits fits;
  fits.camera_mode = rhythm.mode;
  fits.frame_period_s = rhythm.period_s;
  fits.gaps = std::move(rhythm.gaps);
  expose(streams.frames, profile.camera, fits);

  SyncReport sync;
  sync.gyro = labels::fit_gyro_errors(streams.gyro, streams.servo, profile.gyro);
  fit_newer_half(streams, profile, sync.gyro, fits);
  sync.camera_offset = motion::camera_offset(
      streams.frames, streams.gyro, {profile.camera.field_of_view_deg, profile.camera.mirrored}, sync.gyro);
  apply_camera_offset(profile, sync.camera_offset, clocks[Device::camera]);
  sync.servo = labels::fit_servo_response(streams.servo, streams.gyro, sync.gyro, profile.servo,
                                          1.0 / profile.camera.output_rate_hz);

  for (const Device device : all_devices) {
    fits.times[device] = std::move(clocks[device].times);
    sync.clock[device] = std::move(clocks[device].report);
  }
  fits.sync = std::move(sync);
  return fits;
}

}  // namespace thermorig::pipeline
