// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <optional>

#include "odometer_recording.h"
#include "thermorig/core/rate_estimate.h"
#include "thermorig/estimators/odometer/odometer.h"

namespace thermorig::bench {

/// What happens to a measurement before the odometer sees it, so many seconds after the first.
using Disturbance = std::function<void(double seconds, Measurement& measurement)>;

struct JudgedRun {
  double from_s = 0.0;       // the odometer sees nothing of the recording before
  Disturbance disturb;       // none: as it was recorded
  int lost_one_of = 0;       // frames: the n-th of each n never comes; 0: all come
  bool loses_turns = false;  // the harm hides whole turns: they are not asked for after it
  bool tells_rows = false;   // in which order the camera exposes its rows is asked for
  std::optional<double> harm_begin_s, harm_end_s;  // since the first measurement that it sees
};

/// How the odometer did, from 30 s on. Angles: its heading less the shaft's, both zero at the first
/// measurement that it tracks. Degrees, seconds.
struct Judgement {
  std::optional<double> tracked_after_s;  // of the first measurement that it saw
  double not_tracked = 1.0;               // share of the measurements
  double worst_deg = 0.0, offset_deg = 0.0, spread_deg = 0.0, drift_deg_per_min = 0.0;
  double rate_rmse_dps = 0.0;         // of all that it tracked
  double steady_rate_rmse_dps = 0.0;  // of valid frames: at a constant speed
  double coverage = 0.0;              // share within two sigmas about the mean
  double rate_coverage = 0.0;
  double mean_nis = 0.0;
  double silent_s = 0.0;  // for how long at most it was beyond 3 sigma and 3 deg off, and said nothing
  std::optional<double> said_after_s;  // of the begin of the harm: not tracking
  std::optional<double> back_after_s;  // of its end: tracking
  double back_deg = 0.0;               // largest angle from 10 s after the harm on
  double worst_two_minutes_deg = 0.0;  // root mean square of the angle in the worst of them, after the first
  std::optional<odometer::Report> last;  // of a run that tells rows
};

/// What is judged: says of each measurement, one after the other.
using Judged = std::function<RateEstimate(const Measurement&)>;

Judgement judge(const OdometerRecording& recording, const JudgedRun& run, const Judged& judged);

/// Makes one that has seen nothing yet.
using BeginJudged = Judged (*)(const OdometerRecording&);

/// The product's odometer.
Judged odometer_of(const OdometerRecording& recording);
Judgement judge(const OdometerRecording& recording, const JudgedRun& run = {});

/// Processor time that a measurement takes, the start included, microseconds.
struct StepTimes {
  double median_us = 0.0, worst_us = 0.0;
  double slower = 1.0;  // median of the last quarter against that of the second
};

/// Of two runs over the recording, from `from_s` on: each step does the same in both, so that what it took
/// longer in one of them is the computer's.
StepTimes time_steps(const OdometerRecording& recording, double from_s, BeginJudged begin);

}  // namespace thermorig::bench
