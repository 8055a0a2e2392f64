// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "thermorig/core/profile.h"
#include "thermorig/core/raw_recording.h"
#include "thermorig/core/sample.h"
#include "thermorig/core/sync.h"
#include "thermorig/pipeline/labels/frame_gaps.h"
#include "thermorig/pipeline/pipeline.h"

namespace thermorig::fit {

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
ClockFit fit_servo_clock(const RawStream& received, const RawStream& sent, const pipeline::Streams& streams,
                         const ServoProfile& profile);

/// Of a servo that counts its steps and has no time: how much faster than it states it turns, by the angles
/// that it reports over its steady legs, in which no silence is longer than `longest_gap_s`. Their times are
/// those of arrivals, so that seconds are needed. None: too little is steady for a share of a thousandth, or
/// the angles are further off than any clock.
std::optional<double> rate_scale_by_steps(std::span<const TimedServo> servo, double longest_gap_s);

/// One piece of a device's stream between two of its absences, and the clock fitted to it.
struct ClockPiece {
  ClockFit fit;
  std::vector<Stamp> causal;  // of its messages: they stand where too little came for a fit
};

/// One clock of all pieces, which have nothing to do with each other: each begins a new epoch, with a gap
/// before it. Figures of the report are means over the messages, the largest ones the largest of all.
/// `device`: its name, for the reasons.
ClockFit joined(std::vector<ClockPiece> pieces, const std::string& device, double nominal_rate_hz);

}  // namespace thermorig::fit
