// SPDX-License-Identifier: MIT
#include "thermorig/rig/recording/preflight.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "thermorig/core/auto_zero.h"
#include "thermorig/sensors/gyro_protocol.h"

namespace thermorig::rig {

namespace {

using Violations = std::vector<PreflightViolation>;

std::string what_is_sent(Device device) {
  constexpr const char* names[] = {"frames", "samples", "messages"};
  return names[index_of(device)];
}

std::string_view rate_advice(Device device, bool slow) {
  if (device == Device::camera)
    return "the camera does not send at the profile's rate: set the rate that it has (--camera-rate, or "
           "output_rate_hz in the rig profile); a link that is too slow loses frames, too";
  if (device == Device::gyro)
    return slow ? "set output_rate_hz in the rig profile to the gyro's rate, or change the gyro's rate; 9600 "
                  "baud carries at most 87 samples a second"
                : "set output_rate_hz in the rig profile to the gyro's rate";
  return "reflash the servo board with this program's firmware (firmware_servo); end programs that keep this "
         "computer busy";
}

PreflightViolation lost_messages(Device device, const PreflightStream& stream, double limit) {
  const std::string name(name_of(device));
  return {name + "_lost", device,
          fmt::format("{:.1f} % of the {}'s {} are missing", 100.0 * stream.lost_share, name,
                      what_is_sent(device)),
          fmt::format("at most {:.0f} %", 100.0 * limit),
          "another cable or USB port, without a hub; end programs that keep this computer busy"};
}

/// Missing frames are judged as such: a camera that sends at its rate over a link that loses some has no
/// other one.
double due_hz(Device device, const PreflightStream& stream) {
  const double missing_share = device == Device::camera ? std::min(stream.lost_share, 0.99) : 0.0;
  return stream.rate_hz / (1.0 - missing_share);
}

void judge_rate(Device device, const PreflightStream& stream, const PreflightLimits& limits,
                Violations& found) {
  const std::string name(name_of(device));
  const double low_hz = limits.rate_low * stream.nominal_hz;
  const double high_hz = limits.rate_high * stream.nominal_hz;
  if (due_hz(device, stream) >= low_hz && stream.rate_hz <= high_hz) return;
  found.push_back({name + "_rate", device,
                   fmt::format("the {} sends {:.1f} {} a second", name, stream.rate_hz, what_is_sent(device)),
                   fmt::format("{:.4g} to {:.4g} (nominal {:.4g})", low_hz, high_hz, stream.nominal_hz),
                   std::string(rate_advice(device, stream.rate_hz < low_hz))});
}

void judge_stream(Device device, const PreflightStream& stream, const PreflightLimits& limits,
                  Violations& found) {
  const std::string name(name_of(device));
  if (stream.damaged_share > limits.damaged_share)
    found.push_back(
        {name + "_damaged", device,
         fmt::format("{:.1f} % of the {}'s bytes are in no valid message", 100.0 * stream.damaged_share,
                     name),
         fmt::format("at most {:.1f} %", 100.0 * limits.damaged_share),
         "another or a shorter cable; check the baud rate (thermorig ports), and that no other program "
         "reads this port"});
  if (stream.uncertainty_s > limits.uncertainty_s[device])
    found.push_back({name + "_clock", device,
                     fmt::format("the times of the {}'s {} are known to {:.1f} ms only", name,
                                 what_is_sent(device), 1e3 * stream.uncertainty_s),
                     fmt::format("at most {:.1f} ms", 1e3 * limits.uncertainty_s[device]),
                     "end programs that keep this computer busy; a USB port without a hub; thermorig doctor "
                     "checks latency timers"});
}

/// A bridge that misses halves, or repeats frames, does so by chance: of a few seconds' frames a few prove
/// nothing. Three standard deviations of a share of so many.
double by_chance(double share, std::uint64_t count) {
  return 3.0 * std::sqrt(share * (1.0 - share) / static_cast<double>(count));
}

PreflightViolation repeated_frames(const PreflightImages& images, double limit) {
  return {"camera_repeats", Device::camera,
          fmt::format("{:.0f} % of the frames repeat the one before", 100.0 * images.repeated_share),
          fmt::format("at most {:.0f} %", 100.0 * limit),
          "lower the camera's frame rate (its bridge sends more often than its sensor measures), or switch "
          "it off and on"};
}

PreflightViolation lost_halves(const PreflightImages& images, double limit) {
  return {"camera_halves", Device::camera,
          fmt::format("the camera skips {:.1f} % of the half-frames", 100.0 * images.lost_half_share),
          fmt::format("at most {:.0f} %", 100.0 * limit),
          "lower the camera's frame rate (--camera-rate, output_rate_hz in the rig profile): its bridge is "
          "too slow for its sensor; another cable does not help"};
}

/// Those that came and those that did not.
std::uint64_t all_due(std::uint64_t came, double lost_share) {
  return came + static_cast<std::uint64_t>(lost_share * static_cast<double>(came) /
                                           std::max(1.0 - lost_share, 0.01));
}

/// Halves that a bridge misses make fewer frames, which no cable brings back.
bool loses_halves(const PreflightFacts& facts, const PreflightLimits& limits) {
  return facts.images && facts.images->lost_half_share > limits.lost_half_share_bearable;
}

bool is_surely_above(double share, std::uint64_t count, double limit) {
  return share - by_chance(share, count) > limit;
}

bool is_surely_below(double share, std::uint64_t count, double limit) {
  return share + by_chance(share, count) < limit;
}

void judge_images(const PreflightImages& images, const PreflightLimits& limits, Violations& found) {
  const double least_fresh = std::min(images.even_fresh_share, images.odd_fresh_share);
  if (is_surely_below(least_fresh, images.frames, limits.fresh_share))
    found.push_back(
        {"camera_fresh", Device::camera,
         fmt::format("the even and the odd half-frame are new in {:.0f} % and {:.0f} % of the frames",
                     100.0 * images.even_fresh_share, 100.0 * images.odd_fresh_share),
         fmt::format("each in at least {:.0f} %", 100.0 * limits.fresh_share),
         "set the camera's frame rate again, and switch it off and on; a bridge that sends more often than "
         "its sensor measures repeats frames"});
  else if (is_surely_above(images.lost_half_share, all_due(images.frames, images.lost_half_share),
                           limits.lost_half_share))
    found.push_back(lost_halves(images, limits.lost_half_share));
  if (is_surely_above(images.repeated_share, images.frames, limits.repeated_share))
    found.push_back(repeated_frames(images, limits.repeated_share));
}

/// What is not refused: the labels of all other frames are as good as ever.
void warn(PreflightViolation warning, std::string consequence, const Violations& found,
          Violations& warnings) {
  const auto is_told = [&](const PreflightViolation& other) { return other.name == warning.name; };
  if (std::any_of(found.begin(), found.end(), is_told)) return;
  warning.consequence = std::move(consequence);
  warnings.push_back(std::move(warning));
}

std::string what_missing_frames_do(double limit) {
  return fmt::format(
      "the recording goes on: windows never span gaps, but the plan takes longer; the verdict will be "
      "usable, or bad if more than {:.0f} % are missing",
      100.0 * limit);
}

void warn_of_images(const PreflightImages& images, const PreflightLimits& limits, const Violations& found,
                    Violations& warnings) {
  if (images.repeated_share > limits.repeated_share_bearable)
    warn(repeated_frames(images, limits.repeated_share_bearable),
         "the recording goes on: repeated frames are not valid", found, warnings);
  if (images.lost_half_share > limits.lost_half_share_bearable)
    warn(lost_halves(images, limits.lost_half_share_bearable), what_missing_frames_do(limits.lost_half_share),
         found, warnings);
}

/// One frame of the few that come in some seconds proves little; of the other devices it is many messages.
void judge_losses(Device device, const PreflightStream& stream, const PreflightLimits& limits,
                  PreflightReport& report) {
  if (stream.lost_share <= limits.lost_share) return;
  if (device != Device::camera)
    return report.violations.push_back(lost_messages(device, stream, limits.lost_share));
  if (is_surely_above(stream.lost_share, all_due(stream.messages, stream.lost_share),
                      limits.lost_frame_share))
    return report.violations.push_back(lost_messages(device, stream, limits.lost_frame_share));
  warn(lost_messages(device, stream, limits.lost_share), what_missing_frames_do(limits.lost_frame_share),
       report.violations, report.warnings);
}

void judge_rest(const PreflightRest& rest, const GyroProfile& gyro, const PreflightLimits& limits,
                Violations& found) {
  const std::string stand_still =
      "put the rig on something firm and do not touch it until the sweep begins; a motor or a fan nearby can "
      "shake it; counts that are read as deg/s look like this, too: check the gyro's unit";
  if (rest.noise_dps > limits.noise_dps)
    found.push_back({"gyro_noise", Device::gyro,
                     fmt::format("the gyro's rate varies by {:.2f} deg/s at rest", rest.noise_dps),
                     fmt::format("at most {:.2f} deg/s", limits.noise_dps), stand_still});
  else if (rest.swing_dps > limits.swing_dps)
    found.push_back(
        {"gyro_swing", Device::gyro,
         fmt::format("the rig turns: the gyro's mean rate changes by {:.2f} deg/s at rest", rest.swing_dps),
         fmt::format("at most {:.2f} deg/s", limits.swing_dps), stand_still});
  const double off_dps = std::abs(rest.mean_dps - gyro.bias_dps);
  const double limit_dps = limits.bias_deviations * gyro.bias_uncertainty_dps;
  if (!rest.zeroes_itself && !gyro.bias_measured_utc.empty() &&
      off_dps > std::max(limit_dps, limits.swing_dps))
    found.push_back({"gyro_bias", Device::gyro,
                     fmt::format("the gyro shows {:.2f} deg/s at rest, but its measured bias is {:.2f}",
                                 rest.mean_dps, gyro.bias_dps),
                     fmt::format("within {:.2f} deg/s of it", std::max(limit_dps, limits.swing_dps)),
                     "keep the rig still; a cold gyro has another bias: wait some minutes, then `thermorig "
                     "calibrate bias`"});
}

void warn_of_rest(const PreflightRest& rest, const PreflightLimits& limits, Violations& warnings) {
  if (!rest.zeroes_itself && rest.noise_dps < limits.least_noise_dps)
    warnings.push_back(
        {"gyro_unit", Device::gyro,
         fmt::format("the gyro's rate varies by only {:.4f} deg/s at rest", rest.noise_dps),
         fmt::format("at least {:.3f} deg/s", limits.least_noise_dps),
         "no such gyro is so quiet: check its unit (rad/s read as deg/s?) and how many decimals it sends"});
  if (rest.zeroes_itself)
    warnings.push_back(
        {"gyro_zeroes", Device::gyro,
         "the gyro zeroes itself at rest and so hides its bias: it reads exactly 0 on all axes",
         fmt::format("fewer than {} such samples in a row", AutoZero::fewest_zeros),
         "switch that off in the device (WitMotion: registers 61 and 63)"});
}

/// Counted samples of a steady gyro have times as good as its own would be.
void warn_of_times(const PreflightStream& stream, const GyroProfile& gyro, Violations& warnings) {
  if (stream.own_time_unused.empty()) return;
  warnings.push_back(
      {.name = "gyro_times",
       .device = Device::gyro,
       .figure = "the gyro's own times are not those of its samples: " + stream.own_time_unused,
       .limit = "one time a sample",
       .advice = sensors::gyro_protocol(gyro.protocol).has_columns
                     ? "time_column = -1 in [gyro.text] of the rig profile, or print the time at "
                       "which each sample was taken"
                     : "have the device stamp each sample when it is taken",
       .consequence = "its times are not used; samples are counted instead"});
}

void judge_answers(const PreflightAnswers& answers, const ServoProfile& servo, const PreflightLimits& limits,
                   Violations& found) {
  if (answers.limit_rate_dps > 0.0 && servo.max_rate_dps > answers.limit_rate_dps)
    found.push_back({"servo_limits", Device::servo,
                     fmt::format("the rig profile lets the servo turn at {:.4g} deg/s", servo.max_rate_dps),
                     fmt::format("{:.4g} deg/s, by its firmware", answers.limit_rate_dps),
                     "a lower max_rate_dps in the rig profile, or the firmware of this program "
                     "(firmware_servo)"});
  const auto answered = static_cast<double>(answers.answered);
  const auto requests = static_cast<double>(answers.requests);
  if (answers.requests > 0 && answered < limits.answered_share * requests)
    found.push_back({"servo_answers", Device::servo,
                     fmt::format("the servo answered {} of {} requests", answers.answered, answers.requests),
                     fmt::format("at least {:.0f} %", 100.0 * limits.answered_share),
                     "another or a shorter cable; check the supply of the servo's board"});
  if (answers.round_trip_s > limits.round_trip_s)
    found.push_back({"servo_round_trip", Device::servo,
                     fmt::format("the servo's answers take {:.0f} ms", 1e3 * answers.round_trip_s),
                     fmt::format("at most {:.0f} ms: later ones count as lost", 1e3 * limits.round_trip_s),
                     "end programs that keep this computer busy; a USB port without a hub"});
}

}  // namespace

PreflightReport judge(const PreflightFacts& facts, const RigProfile& profile, const PreflightLimits& limits) {
  PreflightReport report{.facts = facts, .violations = {}, .warnings = {}};
  Violations& found = report.violations;
  if (facts.images) judge_images(*facts.images, limits, found);
  for (const Device device : all_devices) {
    if (!facts.streams[device]) continue;
    const bool is_told = device == Device::camera && loses_halves(facts, limits);
    if (!is_told) {
      judge_rate(device, *facts.streams[device], limits, found);
      judge_losses(device, *facts.streams[device], limits, report);
    }
    judge_stream(device, *facts.streams[device], limits, found);
  }
  if (facts.images) warn_of_images(*facts.images, limits, found, report.warnings);
  if (facts.rest) judge_rest(*facts.rest, profile.gyro, limits, found);
  if (facts.streams[Device::gyro]) warn_of_times(*facts.streams[Device::gyro], profile.gyro, report.warnings);
  if (facts.rest) warn_of_rest(*facts.rest, limits, report.warnings);
  if (facts.answers) judge_answers(*facts.answers, profile.servo, limits, found);
  return report;
}

std::string sentence(const PreflightViolation& violation) {
  return fmt::format("{}; the limit is {}{}{}", violation.figure, violation.limit,
                     violation.consequence.empty() ? "" : "; ", violation.consequence);
}

}  // namespace thermorig::rig
