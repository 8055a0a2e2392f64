// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "thermorig/core/chunk.h"
#include "thermorig/core/frame.h"
#include "thermorig/core/freshness.h"
#include "thermorig/core/reading.h"
#include "thermorig/core/time.h"
#include "thermorig/core/validity.h"

namespace thermorig {

/// When a sample really happened, as well as we know.
struct Stamp {
  HostTime time{};     // modelled: for a frame the end of its newest exposure, else the sample instant
  HostTime arrival{};  // when the read() returned that brought the message's last byte
  float uncertainty_s =
      0.0F;  // one standard deviation of the clock; a constant error of the latency is not in it
  float earlier_s = 0.0F;  // bounds, latency taken as it is: not before time - earlier_s,
  float later_s = 0.0F;    // not after time + later_s
};

/// When the pixels of one chess half were exposed.
struct HalfExposure {
  HostTime begin{};
  HostTime end{};
  bool operator==(const HalfExposure&) const = default;

  /// It ends after its begin, and is no longer than one of a half at 0.5 frames a second: what clocks and
  /// lost frames make of others is none.
  bool is_possible() const { return end > begin && end - begin <= std::chrono::seconds(4); }
};

/// A frame with its place in the byte stream and its time.
struct TimedFrame {
  ThermalFrame frame;
  StreamSpan span;
  Stamp stamp;                   // stamp.time: end of the exposure of the newest half
  std::uint16_t fresh_even = 0;  // pixels that differ from the frame before, even chess half (0..384)
  std::uint16_t fresh_odd = 0;   // the same for the odd half
  std::array<HalfExposure, 2>
      half{};                        // when the even and the odd chess half were exposed that the frame shows
  HostTime exposure_begin{};         // start of the older half's exposure
  HostTime exposure_end{};           // end of the newest half's exposure
  bool resync_before = false;        // bytes were skipped between the frame before and this one
  std::uint16_t missing_before = 0;  // frames that never came between the frame before and this one
  bool late = false;       // read more than half a frame period after it was due: its time is not known
  bool stale = false;      // repeats the frame before, or the half that was due did not come
  bool half_lost = false;  // the latter: it shows the one before it still
  bool stands_in = false;  // for one of a camera that is missing: it has no image, every pixel is NaN

  /// That chess half was read anew.
  bool is_fresh(unsigned parity) const {
    return (parity == 0 ? fresh_even : fresh_odd) > Freshness::threshold;
  }
  /// The chess halves, the one that was exposed last behind the other.
  std::array<unsigned, 2> halves_by_time() const {
    const unsigned first = half[0].end <= half[1].end ? 0U : 1U;
    return {first, first ^ 1U};
  }
};

struct TimedGyro {
  GyroReading reading;
  StreamSpan span;
  Stamp stamp;
  float rate_dps = 0.0F;     // about the servo's axis: axis and sign of the profile applied, bias not removed
  bool lost_before = false;  // bytes were skipped between the sample before and this one
};

struct TimedServo {
  ServoState state;
  StreamSpan span;
  Stamp stamp;
  std::int64_t mcu_time_us = 0;  // mcu_us unwrapped
  bool lost_before = false;      // the sequence number or skipped bytes show a loss
};

/// A measured angle of the shaft with its time.
struct TimedShaft {
  ShaftReading reading;
  StreamSpan span;
  Stamp stamp;
  std::int64_t mcu_time_us = 0;  // reading.mcu_us unwrapped
  // Turns counted, direction and errors of the sensor taken off as the profile has them; NaN: no angle.
  double angle_deg = std::numeric_limits<double>::quiet_NaN();
  bool lost_before = false;  // readings are missing: turns are counted anew from here on
};

/// An answer to a ping: the raw material for the servo's clock.
struct TimedPong {
  std::uint32_t token = 0;
  std::uint32_t receive_us = 0;  // micro-controller time at which the ping's last byte came in
  std::uint32_t send_us = 0;     // micro-controller time at which the answer's first byte went out
  StreamSpan span;
  HostTime arrival{};
};

/// One frame with its label: a row of `/samples`.
struct LabelledSample {
  std::uint32_t frame_index = 0;  // index into the camera's frames, from 0
  HostTime time{};                // middle of the exposure of the newest half
  HostTime exposure_begin{};
  HostTime exposure_end{};
  float rate_shaft_dps =
      0.0F;  // mean speed of the shaft over the exposure by the servo model, NaN if unknown
  float rate_shaft_min_dps = 0.0F;
  float rate_shaft_max_dps = 0.0F;
  float rate_commanded_dps =
      0.0F;  // the paper's label: commanded speed over the exposure by the pulses, NaN if unknown
  std::array<float, 2>
      rate_shaft_half_dps{};  // the same three over each chess half's own exposure: even, odd
  std::array<float, 2> rate_commanded_half_dps{};
  std::array<float, 2> rate_gyro_half_dps{};
  float angle_commanded_deg = 0.0F;  // commanded angle at `time`, NaN if unknown
  float rate_gyro_dps = 0.0F;        // mean of the gyro over the exposure, NaN if there is no sample
  std::uint16_t gyro_count = 0;      // how many samples made it
  float gyro_spread_dps =
      0.0F;  // standard deviation over the exposure after a running mean over one pulse period
  float rate_shaft_uncertainty_dps =
      0.0F;  // of rate_shaft, one standard deviation, what is not calibrated included
  // rate_commanded, corrected by what the session measured of the servo; where it could not, rate_commanded.
  // NaN: unknown, as in files of formats before it.
  float rate_corrected_dps = std::numeric_limits<float>::quiet_NaN();
  std::array<float, 2> rate_corrected_half_dps{std::numeric_limits<float>::quiet_NaN(),
                                               std::numeric_limits<float>::quiet_NaN()};
  // How far these two may be from the shaft's true speed, one standard deviation; NaN: unknown.
  float rate_commanded_uncertainty_dps = std::numeric_limits<float>::quiet_NaN();
  float rate_corrected_uncertainty_dps = std::numeric_limits<float>::quiet_NaN();
  // Where the shaft is measured: its angle at `time`, and its mean speed over the exposure and over each
  // half's, by the sensor alone. NaN: not measured then, or by a sensor that is not believed.
  double angle_measured_deg = std::numeric_limits<double>::quiet_NaN();
  float rate_measured_dps = std::numeric_limits<float>::quiet_NaN();
  std::array<float, 2> rate_measured_half_dps{std::numeric_limits<float>::quiet_NaN(),
                                              std::numeric_limits<float>::quiet_NaN()};
  float rate_measured_uncertainty_dps = std::numeric_limits<float>::quiet_NaN();  // one standard deviation
  std::uint32_t reason_bits = 0;                                                  // `bit(Reason)`s
  std::uint16_t leg = 0;  // leg that the servo reported, 0 outside legs
  std::uint32_t run = 0;  // unbroken run of valid frames within one leg, from 1; 0 if not valid
  bool valid = false;

  /// Number of the first reason, counted from 1; 0 if there is none.
  std::uint8_t first_reason() const;
};

}  // namespace thermorig
