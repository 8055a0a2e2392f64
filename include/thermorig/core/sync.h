// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "thermorig/core/device.h"
#include "thermorig/core/estimate.h"
#include "thermorig/core/time.h"

namespace thermorig {

// What a whole recording says about its clocks, its sensors and its servo: the result of the first pass over
// the bytes, used by the second, stored in `/sync` and printed by `inspect --timing`.

/// An instant of the host's clock, how well it is known, and within which bounds it lies.
struct TimeEstimate {
  HostTime time{};
  float uncertainty_s = 0.0F;  // one standard deviation
  float earlier_s = 0.0F;      // the true time is not before time - earlier_s
  float later_s = 0.0F;        // and not after time + later_s
};

/// One piece of a fitted clock, where it was anchored.
struct ClockKnot {
  HostTime time{};        // host time
  double offset_s = 0.0;  // host time minus device time at the knot
  double skew_ppm = 0.0;  // how much faster host time runs than device time there
  double residual_us =
      0;  // one-way: median lateness of the chunks around; two-way: half the width of the bounds
};

/// A stretch of a device's clock without a reset: it ends where no clock explains both sides of it.
struct ClockEpoch {
  HostTime begin{};
  std::string reason;  // why the one before ended, ready to print; empty for the first
};

/// A stretch in which messages were lost.
struct ClockGap {
  HostTime begin{};  // time of the last message before it
  HostTime end{};    // time of the first one after it
  std::uint64_t missing = 0;
};

/// How the clock of one device did over a recording.
struct ClockReport {
  std::string method;  // "one-way" or "two-way"; empty: too little came, or it sends no time
  std::string
      own_time_unused;   // why samples were counted though the device sends a time; empty: they were not
  double rate_hz = 0.0;  // messages a second, measured
  // Mean: device slower than nominal is positive. Also of a servo that has no time and counts its steps.
  double skew_ppm = 0.0;
  double wander_ppm = 0.0;   // root mean square of the knots' skew about its mean
  double late_p50_us = 0.0;  // lateness of the chunks that were read: arrival minus the fitted clock
  double late_p95_us = 0.0;
  double late_max_us = 0.0;
  double uncertainty_us = 0.0;  // median over the messages, one standard deviation, latency's error not in it
  double bound_us = 0.0;        // widest distance of the bounds
  double bound_median_us = 0.0;
  // The bounds hold for a clock whose rate, within any minute, stays so close to its mean over that minute.
  // Checked: half of it explains everything that was heard. 0: not checked, or nothing explains it.
  double bound_wander_ppm = 0.0;
  // What of it was needed: twice the least wander, of those tried, that explains everything, and not barely.
  // Where it is less than bound_wander_ppm, nothing speaks for more, but what was heard would not have told
  // it. Infinite: none of those tried explains it. 0: not checked.
  double needed_wander_ppm = 0.0;
  double largest_constant_delay_s = 0.0;  // setting that a one-way lower bound rests on
  double latency_s = 0.0;                 // constant that was subtracted
  double latency_uncertainty_s = 0.0;
  std::vector<ClockKnot> knots;
  std::vector<ClockEpoch> epochs;
  std::vector<ClockGap> gaps;
};

/// A calibrated constant no longer holds where a session's own value lies so many standard deviations away.
inline constexpr double contradiction_deviations = 3.0;

inline bool contradict(const Estimate& a, const Estimate& b) {
  return std::abs(a.value - b.value) > contradiction_deviations * std::hypot(a.uncertainty, b.uncertainty);
}

/// How long the camera's sample-to-byte delay exceeds what its profile says, by the motion in its images
/// against the gyro: to be added to the camera's latency.
struct CameraOffset {
  std::optional<Estimate> offset_s;  // of the middle rows; none: the recording does not tell
  std::string why_not;               // ready to print, if there is none
  std::uint32_t halves = 0;          // chess halves that took part
  bool applied = false;              // the camera's times were shifted by (a share of) it
  bool contradicts = false;          // a calibrated latency: beyond contradiction_deviations
  // How much later each row was exposed than the one above it, by the upper and the lower rows apart: 0 where
  // all rows are exposed at once. None: the recording does not tell.
  std::optional<Estimate> row_delay_s;
};

/// The gyro's bias at an instant.
struct BiasKnot {
  HostTime time{};
  double bias_dps = 0.0;
};

/// The gyro's errors about the servo's axis: rate = scale * true rate + bias.
struct GyroErrors {
  Estimate scale{1.0, 0.03};
  bool scale_calibrated = false;
  // By whole turns that close in this session's images, which owes nothing to the profile. None: why not.
  std::optional<Estimate> scale_by_turns;
  std::string scale_why_not;       // ready to print
  bool scale_contradicts = false;  // a calibrated scale: it gave way to that of the turns
  // Group delay of the gyro's low-pass. It is part of the latency that is taken off the gyro's times.
  Estimate filter_delay_s{0.0, 0.0};
  std::string filter_source;         // "profile", "device" (read back), "noise" at rest, or empty
  bool filter_contradicts = false;   // the profile's delay: it gave way to that of the noise
  std::optional<Estimate> bias_dps;  // over the recording's rests, else of the profile; none: unknown
  // At rest before the first leg: the static bias, all that there is to be known of it before anything turns.
  // Arming moves the shaft, and a hand may turn the rig: such parts do not count. None: no quiet rest.
  std::optional<double> bias_before_dps;
  std::optional<double> bias_after_dps;  // at the closing rest
  // How the bias went, straight between knots and constant beyond them; empty: it stayed at bias_dps.
  std::vector<BiasKnot> bias_course;
  double noise_dps = std::numeric_limits<double>::quiet_NaN();  // of a sample at rest; NaN: no rest was seen
  bool zeroes_itself = false;   // runs of exact zeros at rest: the device hides its bias
  double decay_per_s = 0.0;     // share of a steady rate that it loses in a second; 0: none is seen
  bool bias_from_legs = false;  // bias_dps is what remains of equal speeds in both directions, not of rests
};

/// The gyro's bias at a time, by its course where it has one; NaN: not known.
double bias_dps_at(const GyroErrors& errors, HostTime time);

/// How the shaft follows the pulses. A positional servo's angle follows the angle that the pulses command as
/// a second-order loop of damping 0.7, a continuous one's rate follows the commanded rate as a first-order
/// lag; the shaft then turns by scale * gain times that.
struct ServoResponse {
  bool fitted = false;                // against the gyro of this recording; else of the profile
  double delay_s = 0.005;             // pure delay from a pulse's end to the shaft
  double delay_uncertainty_s = 0.01;  // one standard deviation, the gyro's clock in it
  double loop_hz = 8.0;               // bandwidth of the servo's own loop
  double dead_band_deg = 0.0;         // positional: angle errors within half of it, either way, move nothing
  Estimate scale{1.0, 0.015};         // shaft angle per commanded angle
  bool scale_calibrated = false;
  Estimate gyro_ratio{1.0, 0.034};  // corrected gyro over commanded rate: scale as the gyro alone sees it
  std::vector<double> gain;  // slope over its mean, at evenly spaced pulse widths from the shortest to the
                             // longest, straight between them; empty: 1 everywhere
  // By what the slope repeats over the shaft's angle: a wheel off its centre, a head out of balance. Each is
  // a share of the slope, a sum over all of them: forward (angles that grow) cosine * cos(phase) + sine *
  // sin(phase), phase = 2 pi * angle / period_deg, and its own two the other way, for gears have play. The
  // angle is what gain alone makes of the commanded one, 0 in the middle of the travel. Empty: none is seen.
  struct Ripple {
    double period_deg = 360.0;
    double forward_cosine = 0.0, forward_sine = 0.0;
    double backward_cosine = 0.0, backward_sine = 0.0;
  };
  std::vector<Ripple> ripples;
  // Root mean square of corrected gyro minus model in the steady parts of legs, means over a frame period.
  // NaN: not known, for nothing was fitted or no leg was steady for a frame.
  double residual_dps = std::numeric_limits<double>::quiet_NaN();
  struct AtSpeed {
    double rate_dps = 0.0;      // commanded
    double residual_dps = 0.0;  // mean of corrected gyro minus model
    // Root mean square about that mean, less what the gyro's noise explains; with it what the gyro's low-pass
    // hides of the model.
    double spread_dps = 0.0;
    double noise_dps = 0.0;    // of a gyro sample while the shaft turns, by what is too fast for the shaft
    std::uint32_t frames = 0;  // frame periods at this speed that took part
    double reached_dps = std::numeric_limits<double>::quiet_NaN();  // mean of the corrected gyro
    bool contradicts = false;  // the shaft does not turn as commanded, beyond what scale and bias explain
  };
  std::vector<AtSpeed> speeds;  // of the legs, ascending
};

/// What was seen at that commanded speed; nullptr: it is none of the legs'.
const ServoResponse::AtSpeed* seen_at(const ServoResponse& response, double commanded_dps);

/// Whether the shaft was seen not to turn as commanded at that speed.
bool contradicts_command(const ServoResponse& response, double commanded_dps);

/// Whether the camera's rows are seen to be exposed one after the other.
bool are_rows_apart(const CameraOffset& offset);

/// Who says how fast the shaft turns. `undecided`: two contradict each other, and nothing says who is wrong.
enum class Witness : std::uint8_t { none, command, gyro, images, undecided };

/// What command, gyro and images say of one another, over the steady parts of the legs. A share is a slope:
/// deg/s that one shows for each deg/s commanded.
struct Witnesses {
  std::optional<Estimate> gyro_share;    // of the corrected gyro; none: there was nothing to compare
  std::optional<Estimate> images_share;  // of the images alone, by the profile's lens
  std::string images_why_not;            // ready to print, if there is none
  // Who contradicts the other two by more than contradiction_deviations of what the profile states.
  Witness outlier = Witness::none;
  std::string cause;   // of that, ready to print: who, by which factor, and why that is likely
  std::string remedy;  // ready to print: what to change
};

/// "command", "gyro", "images", "undecided"; empty for none.
std::string_view name_of(Witness witness);
/// The other way; none for any other text.
Witness witness_named(std::string_view name);

/// What measures the shaft, held against gyro and command.
struct ShaftReport {
  std::uint32_t readings = 0;
  std::uint32_t unread = 0;  // of these: without an angle
  std::uint32_t poor = 0;    // of these: with an angle by too weak or too strong a signal
  bool used = false;         // labels are made by it
  std::string why_not;       // ready to print; empty where it is used, and where nothing measures the shaft
  // deg/s that it shows for each deg/s of the corrected gyro, and for each commanded; none: nothing to
  // compare
  std::optional<Estimate> gyro_share, command_share;
  double error_deg = 0.0;  // of what repeats with each turn, root mean square
};

/// Everything of the kind.
struct SyncReport {
  PerDevice<ClockReport> clock;
  std::string bad_pixels;  // of the camera, "3,17 12,5": see core/bad_pixels.h; empty: none was found
  CameraOffset camera_offset;
  GyroErrors gyro;
  ServoResponse servo;
  Witnesses witnesses;
  ShaftReport shaft;
};

}  // namespace thermorig
