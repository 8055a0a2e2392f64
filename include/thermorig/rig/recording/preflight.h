// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "thermorig/core/device.h"
#include "thermorig/core/profile.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::rig {

/// What a recording does with a rig that is not fit for it.
enum class PreflightMode : std::uint8_t {
  off,     // nothing is judged
  warn,    // an event says so, and the recording goes on
  refuse,  // nothing moves, no file is left
};

/// What one device sent while the rig stood still.
struct PreflightStream {
  std::uint64_t messages = 0;
  double rate_hz = 0.0;         // by the arrivals of the first and the last
  double nominal_hz = 0.0;      // by the profile
  double lost_share = 0.0;      // messages missing, by number or by time, of all that were due, 0..1
  double damaged_share = 0.0;   // bytes that belong to no good message, 0..1
  double uncertainty_s = 0.0;   // of the newest message's time, one standard deviation
  std::string own_time_unused;  // why samples are counted though a time comes with each; empty: they are not
};

/// What the camera's images say.
struct PreflightImages {
  std::uint64_t frames = 0;       // that the shares are of
  double even_fresh_share = 0.0;  // frames in which that chess half is new, 0..1
  double odd_fresh_share = 0.0;
  double repeated_share = 0.0;          // frames that repeat the one before
  double lost_half_share = 0.0;         // halves that were due and are in no frame, of those that were due
  double sensor_drift_c_per_min = 0.0;  // of the sensor's own temperature
};

/// What the gyro says at rest: of the axis that moves most. Exact zeros of one that zeroes itself are left
/// out.
struct PreflightRest {
  double mean_dps = 0.0;       // about the servo's axis, sign of the profile applied
  double noise_dps = 0.0;      // standard deviation
  double swing_dps = 0.0;      // between the largest and the smallest mean over half a second
  bool zeroes_itself = false;  // AutoZero: it hides its bias
};

/// How the servo answers, and what it says of itself.
struct PreflightAnswers {
  std::uint64_t requests = 0;  // pings, or reads of its state, that are old enough to have been answered
  std::uint64_t answered = 0;  // of those
  double round_trip_s = 0.0;   // median, without what the firmware held them back on purpose
  std::uint64_t retries = 0;   // of commands, since all devices send
  std::string firmware;        // "1.0.0"
  double uptime_s = 0.0;       // when it was greeted; 0: it does not say
  unsigned reset_cause = 0;    // MCUSR of an AVR
  double limit_rate_dps = 0.0;
  unsigned watchdog_ms = 0;  // 0: it has none
  std::string how_it_rests;  // where nobody reaches it any more
};

/// What is known of a rig at rest, before it moves. Parts of devices that are not there are absent.
struct PreflightFacts {
  double span_s = 0.0;  // for how long all devices were heard
  PerDevice<std::optional<PreflightStream>> streams;
  std::optional<PreflightImages> images;
  std::optional<PreflightRest> rest;
  std::optional<PreflightAnswers> answers;
};

/// Beyond these a rig is not fit to record. Where each comes from stands in docs/reliability.md, "The
/// preflight check".
struct PreflightLimits {
  double rate_low = 0.8;  // of the nominal rate: the next setting of any device is at least 2 away
  double rate_high = 1.25;
  double lost_share = 0.01;  // of gyro and servo; of the camera's frames a warning above it
  double lost_frame_share = session::most_missing_frames;
  double damaged_share = 0.01;
  PerDevice<double> uncertainty_s{{0.010, 0.010, 0.005}};
  double fresh_share = 0.25;  // each chess half, of the frames; half of that in half-fresh mode would be none
  double lost_half_share = session::most_missing_frames;
  double lost_half_share_bearable = 0.01;  // above it a warning
  double repeated_share = 0.10;
  double repeated_share_bearable = 0.01;  // above it a warning
  double noise_dps = 1.0;                 // 20 times what an MPU6050 has (data sheet: 0.05 deg/s rms)
  double least_noise_dps = 0.005;         // a warning below it: a tenth of that
  double swing_dps = 1.0;
  double bias_deviations = 5.0;  // from the profile's bias, where that was measured
  double answered_share = 0.90;
  double round_trip_s = 0.080;  // an answer counts as lost then, and its command is sent again
};

/// One figure beyond its limit.
struct PreflightViolation {
  std::string name;  // "gyro_rate", the same in every version: for programs
  Device device = Device::camera;
  std::string figure;  // "the gyro sends 100.1 messages a second"
  std::string limit;   // "160 to 250 (nominal 200)"
  std::string advice;
  std::string consequence;  // of what a recording bears: what becomes of the session
};

/// What was seen, and what of it is beyond its limit.
struct PreflightReport {
  PreflightFacts facts;
  std::vector<PreflightViolation> violations;
  std::vector<PreflightViolation> warnings;  // what a recording bears, but its user should know
  bool passed() const { return violations.empty(); }
};

/// Pure: the same facts give the same report. `profile` names nominal rates, protocol and the measured bias.
PreflightReport judge(const PreflightFacts& facts, const RigProfile& profile,
                      const PreflightLimits& limits = {});

/// "the gyro sends 100.1 messages a second; the limit is 160 to 250 (nominal 200)", and the consequence.
std::string sentence(const PreflightViolation& violation);

}  // namespace thermorig::rig
