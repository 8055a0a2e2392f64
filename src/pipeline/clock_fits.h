// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

#include "thermorig/core/profile.h"
#include "thermorig/core/raw_recording.h"
#include "thermorig/core/sample.h"
#include "thermorig/core/sync.h"
#include "thermorig/pipeline/labels/frame_gaps.h"
#include "thermorig/pipeline/pipeline.h"

namespace thermorig::pipeline {

/// The clock of one device over a recording: the time of each of its messages, and how it did. Without
/// `times` too little came, and the causal ones stand.
struct ClockFit {
  std::vector<TimeEstimate> times;
  ClockReport report;
};

/// Frames carry no number: `gaps` count them.
ClockFit fit_camera_clock(const RawStream& received, std::span<const TimedFrame> frames,
                          std::span<const labels::FrameGap> gaps, const CameraProfile& profile);

/// By the gyro's own time where its clock sends one, else by counting its samples.
ClockFit fit_gyro_clock(const RawStream& received, std::span<const TimedGyro> gyro,
                        const GyroProfile& profile);

/// From both sides where pings were answered, else one-way by the telemetry's own time.
ClockFit fit_servo_clock(const RawStream& received, const RawStream& sent, const Streams& streams,
                         const ServoProfile& profile);

}  // namespace thermorig::pipeline
