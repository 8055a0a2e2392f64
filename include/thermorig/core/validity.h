// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace thermorig {

/// Why a labelled sample may not be trusted: bit numbers of `/samples/reason_bits`. They are stored in files:
/// never renumber them. Rules V0..V8 are those of docs/recording_format.md, "Validity"; what this version
/// computes is defined to the letter in labels/labeller.h.
enum class Reason : std::uint8_t {
  camera_gap = 0,        // V5: frames, or the half that was due, are missing just before this one: a run ends
                         // there; a warning, does not clear `valid`
  camera_not_fresh = 1,  // V5: the frame repeats the one before
  checksum = 2,          // V5: damaged bytes just before this frame
  servo_ramp = 3,        // V0: the shaft's speed by the servo model leaves the commanded one in the exposure
  servo_lost = 4,        // no telemetry over that time, or the servo says disarmed or fault
  gyro_gap = 5,          // too few gyro samples over the exposure
  sync_lost = 6,         // V6: the time is not known well enough: read long after due, or an unsure clock
  warm_up = 7,           // V7: the camera has not settled; a warning, does not clear `valid`
  operator_mark = 8,     // marked by hand
  limit_hit = 9,         // V1: too close to the mechanical stop
  reversal = 10,         // the shaft turns back within the exposure
  outside_leg = 11,      // rest or transit: not part of a leg of the plan
  leg_change = 12,       // V4: the two halves lie in different legs
  gyro_unsteady = 13,  // V2: the gyro's spread after a running mean over one pulse period is wide: a warning,
                       // the labels' uncertainties hold what their means are off
  gyro_disagrees = 14,       // V3: gyro and servo model differ by more than 3 sigma
  telemetry_disagrees = 15,  // V8: a telemetry deadline was missed or the pulse does not follow the command
  out_of_range = 16,         // a pixel outside -60..400 degC or not a number
  no_bias = 17,  // the label would be the gyro's, and no rest tells the gyro's bias: there is no label
};

inline constexpr std::size_t reason_count = 18;

constexpr std::uint32_t bit(Reason reason) {
  return 1U << static_cast<unsigned>(reason);
}

/// Names in the order of the bit numbers, as in the file's `flag_meanings`.
inline constexpr std::array<std::string_view, reason_count> reason_names{
    "camera_gap", "camera_not_fresh", "checksum",       "servo_ramp",          "servo_lost",   "gyro_gap",
    "sync_lost",  "warm_up",          "operator",       "limit_hit",           "reversal",     "outside_leg",
    "leg_change", "gyro_unsteady",    "gyro_disagrees", "telemetry_disagrees", "out_of_range", "no_bias"};

/// Reasons that do not clear `valid`.
inline constexpr std::uint32_t warning_bits =
    bit(Reason::warm_up) | bit(Reason::camera_gap) | bit(Reason::gyro_unsteady);

/// A run does not go on from the frame before to one with these reasons, valid or not.
constexpr bool breaks_run(std::uint32_t reasons) {
  return (reasons & bit(Reason::camera_gap)) != 0;
}

/// Reasons that this version computes; the others are always 0 and marked so in the file.
inline constexpr std::uint32_t computed_bits = ((1U << reason_count) - 1U) & ~bit(Reason::operator_mark);

}  // namespace thermorig
