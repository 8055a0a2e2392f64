// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "thermorig/core/estimate.h"
#include "thermorig/core/profile.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::calibration {

// Each takes a finished session that was recorded for it (or any other that happens to show what is needed),
// and says what it found; apply() writes it into a rig profile, with the date. Throw Error(finished_lossy)
// with the reason where the session cannot tell. Uncertainties are one standard deviation.

/// 60 s at rest: the gyro's bias about the servo's axis. The uncertainty is the spread among parts of the
/// rest, drift included: what another part of the like would differ by. Throws as well where the gyro zeroes
/// itself at rest and so hides its bias.
struct BiasResult {
  Estimate bias_dps;
  double noise_dps = 0.0;  // standard deviation of a sample
  double drift_dps = 0.0;  // last parts minus first parts
  double rest_s = 0.0;     // that took part
};
BiasResult measure_bias(const session::Session& session);

/// Sweeps back and forth: how long the camera takes from the exposure's end to its first byte, beyond what
/// the gyro takes from its sample to its own (whose latency the profile states).
struct LatencyResult {
  Estimate camera_latency_s;  // new value for the profile: what was subtracted plus the measured offset
  double before_s = 0.0;      // what the session's profile says
  Estimate offset_s;          // new value minus before
  std::uint32_t halves = 0;   // chess halves that took part
};
LatencyResult measure_latency(const session::Session& session);

/// A whole turn that closes in the image, by the servo (winch, continuous) or by hand: the gyro's scale, and
/// with it the servo's where the servo drove.
struct ScaleResult {
  Estimate gyro_scale;
  std::optional<Estimate> servo_scale;
  double turned_deg = 0.0;
};
ScaleResult measure_scale(const session::Session& session);

/// The same without an image: the rig was turned by `angle_deg` between marks by hand, from rest to rest,
/// while the servo stood still. Takes the marks to be met to half a degree each.
ScaleResult measure_scale_by_marks(const session::Session& session, double angle_deg);

/// The axis of the gyro that turns with the servo, and how: of any session with legs both ways.
struct GyroAxis {
  int axis = 2;  // 0 x, 1 y, 2 z
  int sign = 1;
  double share = 0.0;        // of the commanded speed, as the profile reads the gyro
  double correlation = 0.0;  // with the commands, 0..1
};
GyroAxis measure_axis(const session::Session& session);

/// Which way is positive: the gyro's axis and sign against the commands, the image against the gyro.
struct OrientationResult {
  int gyro_axis = 2;  // the axis that turns with the servo
  int gyro_sign = 1;
  double correlation = 0.0;  // of that axis with the commands, 0..1
  bool mirrored = true;
  double contrast = 0.0;  // how much better the image fits so than the other way round, 0..1
};
OrientationResult measure_orientation(const session::Session& session);

/// Slow sweeps back and forth, best with a whole turn: where each pixel looks (pitch, distortion, tilt,
/// roll), and over how much of a refresh period rows are exposed one after the other. The order of the
/// columns is the profile's. What the images tell no better than it was known before is not in it. Throws as
/// well where the pitch is not told to two per cent.
struct LensResult {
  Estimate pitch_scale{1.0, 0.0};
  std::optional<Estimate> distortion, tilt_deg, roll_deg, row_spread;  // none: not told
  bool is_closed = false;  // a whole turn closed: the pitch owes nothing to the gyro's scale
  double turned_deg = 0.0;
  std::uint32_t halves = 0;  // chess halves that took part
  // What the gyro's low-pass delays, by its noise: no image tells that, and a heading is late by it.
  std::optional<Estimate> gyro_delay_s;
};
LensResult measure_lens(const session::Session& session);

/// Fast legs of whole turns, held against the gyro: the direction, zero and errors of a sensor on the shaft.
struct EncoderResult {
  std::string sensor;                      // "AS5600"
  EncoderProfile encoder;                  // new values for the profile, but for the date
  double once_deg = 0.0, twice_deg = 0.0;  // amplitudes of its errors once and twice a turn
  double turned_deg = 0.0;
  std::size_t legs = 0;    // that took part
  Estimate gyro_share{};   // deg that the corrected gyro shows for each of the sensor
  double noise_deg = 0.0;  // of a reading
};
EncoderResult measure_encoder(const session::Session& session);

/// Whether distortion, tilt, roll or spread of the rows are another than those of a plain lens, 0: by two
/// standard deviations.
bool is_not_plain(const Estimate& told);

/// Several sessions of the like as one result: means by weight, no surer than the sessions agree with each
/// other. `results` is not empty. Throws Error(finished_lossy) where orientations contradict each other.
BiasResult combined(std::span<const BiasResult> results);
LatencyResult combined(std::span<const LatencyResult> results);
ScaleResult combined(std::span<const ScaleResult> results);
OrientationResult combined(std::span<const OrientationResult> results);
LensResult combined(std::span<const LensResult> results);
EncoderResult combined(std::span<const EncoderResult> results);

void apply(const BiasResult& result, const std::string& utc, RigProfile& profile);
void apply(const LatencyResult& result, const std::string& utc, RigProfile& profile);
void apply(const ScaleResult& result, const std::string& utc, RigProfile& profile);
void apply(const OrientationResult& result, const std::string& utc, RigProfile& profile);
void apply(const EncoderResult& result, const std::string& utc, RigProfile& profile);
/// What it does not tell, or not to be another than that of a plain lens, is taken as a plain lens has it.
void apply(const LensResult& result, const std::string& utc, RigProfile& profile);

/// Calibrations of `from` into `into`, whose ports, rates and servo geometry stay: for a session that was
/// recorded before its rig was calibrated or rightly described. What was measured (what has a date) is taken,
/// and how the data are to be read: columns, unit and settings of a gyro of the same protocol, the field of
/// view, and axis, sign, mirror and scale where neither of the two has measured them.
void take_calibrations(const RigProfile& from, RigProfile& into);

}  // namespace thermorig::calibration
