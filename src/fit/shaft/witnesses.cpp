// SPDX-License-Identifier: MIT
#include "thermorig/fit/shaft/witnesses.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <tuple>
#include <vector>

#include "gyro_integral.h"
#include "reached_speeds.h"
#include "thermorig/core/statistics.h"
#include "thermorig/fit/shaft/intervals.h"

namespace thermorig::fit {

namespace {

// No profile states a scale better than that for this comparison: smaller differences are no wrong unit,
// range or axis, and widen what the scale is stated to (absolute_scale).
constexpr double least_scale_uncertainty = 0.01;
// A scene 1.5 m away turns past a camera that sits 5 cm off the axis as if the lens were 3 % wider.
constexpr double parallax = 0.03;
constexpr double most_saturated = 0.05;  // of the samples: beyond it no mean says how fast the shaft turns
constexpr double most_lean_deg = 10.0;   // as a board is glued by hand; it costs 1.5 % of the rate

/// What the three axes show for each deg/s commanded, as sent, and how often a sample is saturated.
struct Axes {
  std::array<double, 3> share{};
  double saturated = 0.0;
  bool is_known = false;  // else biases are part of the shares: one direction alone, and no rest before it
};

/// What is summed of the three axes over some intervals.
struct AxisSums {
  std::array<double, 3> sums{}, products{};
  double count = 0.0, commanded = 0.0, squares = 0.0, saturated = 0.0;

  AxisSums(std::span<const Interval> intervals, std::span<const TimedGyro> gyro, HostTime origin) {
    auto sample = gyro.begin();
    for (const Interval& interval : intervals) {
      const HostTime begin = origin + from_s(interval.begin_s + settled_after_s);
      const HostTime end = origin + from_s(interval.end_s);
      while (sample != gyro.end() && sample->stamp.time < begin) ++sample;
      for (; sample != gyro.end() && sample->stamp.time < end; ++sample) add(*sample, interval.rate_dps);
    }
  }

  void add(const TimedGyro& sample, double rate_dps) {
    count += 1.0;
    saturated += sample.reading.saturated ? 1.0 : 0.0;
    commanded += rate_dps;
    squares += rate_dps * rate_dps;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto shown_dps = static_cast<double>(sample.reading.rate_dps[axis]);
      if (!std::isfinite(shown_dps)) continue;
      sums[axis] += shown_dps;
      products[axis] += rate_dps * shown_dps;
    }
  }
};

/// While the commanded speed is steady. Biases are what both directions say, else what the rests do.
Axes axes_of(std::span<const Interval> legs, std::span<const Interval> rests, std::span<const TimedGyro> gyro,
             HostTime origin) {
  const AxisSums turning(legs, gyro, origin), still(rests, gyro, origin);
  Axes axes;
  if (turning.count == 0.0) return axes;
  axes.saturated = turning.saturated / turning.count;
  const double determinant = turning.count * turning.squares - turning.commanded * turning.commanded;
  const bool both_ways = determinant > 0.5 * turning.count * turning.squares;
  axes.is_known = both_ways || still.count > 0.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double bias_dps = still.count > 0.0 ? still.sums[axis] / still.count : 0.0;
    axes.share[axis] =
        both_ways
            ? (turning.count * turning.products[axis] - turning.commanded * turning.sums[axis]) / determinant
            : (turning.products[axis] - bias_dps * turning.commanded) / turning.squares;
  }
  return axes;
}

// ---- causes ---------------------------------------------------------------------------------------------

/// What a gyro shows of the true rate where its unit or range is taken for another one.
struct UnitError {
  double factor;
  const char* why;
};
constexpr double degrees_per_radian = 57.29577951;
constexpr std::array unit_errors{
    UnitError{1.0 / degrees_per_radian, "it sends rad/s and is read as deg/s"},
    UnitError{degrees_per_radian, "it sends deg/s and is read as rad/s"},
    UnitError{1000.0 / degrees_per_radian, "it sends mrad/s and is read as deg/s"},
    UnitError{degrees_per_radian / 1000.0, "it sends deg/s and is read as mrad/s"},
    UnitError{1000.0, "it sends mdeg/s and is read as deg/s"},
    UnitError{0.001, "it sends deg/s and is read as mdeg/s"},
    // MPU-6000 register map, GYRO_CONFIG: counts for one deg/s at +-250, 500, 1000 and 2000 deg/s.
    UnitError{131.0, "it sends counts of a range of 250 deg/s (131 a deg/s)"},
    UnitError{65.5, "it sends counts of a range of 500 deg/s (65.5 a deg/s)"},
    UnitError{32.8, "it sends counts of a range of 1000 deg/s (32.8 a deg/s)"},
    UnitError{16.4, "it sends counts of a range of 2000 deg/s (16.4 a deg/s)"},
    UnitError{1.0 / 131.0, "it sends deg/s and is read as counts (131 a deg/s)"},
    UnitError{1.0 / 65.5, "it sends deg/s and is read as counts (65.5 a deg/s)"},
    UnitError{1.0 / 32.8, "it sends deg/s and is read as counts (32.8 a deg/s)"},
    UnitError{1.0 / 16.4, "it sends deg/s and is read as counts (16.4 a deg/s)"},
    UnitError{2.0, "its range is half of what the profile says"},
    UnitError{4.0, "its range is a quarter of what the profile says"},
    UnitError{8.0, "its range is an eighth of what the profile says"},
    UnitError{0.5, "its range is twice what the profile says"},
    UnitError{0.25, "its range is four times what the profile says"},
    UnitError{0.125, "its range is eight times what the profile says"}};

/// The nearest one, if it is within `tolerance` (relative).
const UnitError* unit_error_of(double factor, double tolerance) {
  const auto off = [&](const UnitError& error) { return std::abs(std::log(factor / error.factor)); };
  const auto* const nearest =
      std::min_element(unit_errors.begin(), unit_errors.end(),
                       [&](const UnitError& a, const UnitError& b) { return off(a) < off(b); });
  return off(*nearest) < tolerance ? nearest : nullptr;
}

struct Cause {
  std::string why, remedy;
};

constexpr std::array axis_names{"x", "y", "z"};

/// The axis that turns with the shaft in place of the profile's; none: that one does most.
std::optional<std::size_t> other_axis(const Axes& axes, std::size_t axis) {
  const auto size = [&](std::size_t i) { return std::abs(axes.share[i]); };
  const std::size_t most = size(0) > size(1) ? (size(0) > size(2) ? 0 : 2) : (size(1) > size(2) ? 1 : 2);
  if (most == axis || size(axis) > 0.5 * size(most)) return std::nullopt;
  return most;
}

/// How far the axis leans away from the shaft's, by what the other two show; 0 where nothing turns.
double lean_of(const Axes& axes, std::size_t axis) {
  const double beside = std::hypot(axes.share[(axis + 1) % 3], axes.share[(axis + 2) % 3]);
  return std::atan2(beside, std::abs(axes.share[axis])) * 180.0 / std::numbers::pi;
}

/// Three digits that count.
std::string share_text(double share) {
  return std::abs(share) < 0.0005 ? "0" : fmt::format("{:.3g}", share);
}

/// The line of the profile that takes out a factor; where the protocol fixes the unit, what is to be set in
/// the device.
std::string scale_line(const GyroProfile& profile, double factor) {
  if (profile.protocol == "text")
    return fmt::format("set scale_dps = {:.6g} in [gyro.text] of the profile",
                       profile.text.scale_dps / factor);
  if (const double raw_dps = profile.setting("raw_scale_dps"); raw_dps > 0.0)
    return fmt::format("set raw_scale_dps = {:.4g} in [gyro.{}] of the profile", raw_dps / factor,
                       profile.protocol);
  return fmt::format(
      "set the device to the range and unit of its protocol, of which it shows {}, or scale = {:.4g} in "
      "[gyro] "
      "of the profile",
      share_text(factor), profile.scale * factor);
}

/// `share`: of the gyro; `expected`: what it should be; `tolerance`: relative, of their ratio.
Cause gyro_cause(const Axes& axes, double share, double expected, double tolerance,
                 const GyroProfile& profile) {
  const auto axis = static_cast<std::size_t>(profile.axis);
  if (const auto other = other_axis(axes, axis);
      axes.is_known && other && std::abs(axes.share[*other]) > least_turning_share / 2.0)
    return {fmt::format("its {} axis turns with the shaft and not its {} axis", axis_names[*other],
                        axis_names[axis]),
            fmt::format("set axis = \"{}\" and sign = {} in [gyro] of the profile", axis_names[*other],
                        axes.share[*other] < 0.0 ? -1 : 1)};
  const double factor = share / expected;
  const std::string turned = factor < 0.0 ? "it is mounted the other way round" : "";
  if (std::abs(profile.scale - 1.0) > tolerance && std::abs(factor * profile.scale - 1.0) < tolerance)
    return {fmt::format("the profile's scale of it, {:.3g}", profile.scale),
            "set scale = 1 in [gyro] of the profile"};
  const UnitError* const unit = unit_error_of(std::abs(factor), tolerance);
  if (unit == nullptr && std::abs(factor) < least_turning_share)
    return {"it does not turn with the shaft, or no sensor is behind it",
            "fix the gyro to the shaft, and check its wiring"};
  if (unit == nullptr && !turned.empty() && std::abs(std::abs(factor) - 1.0) < tolerance)
    return {turned, fmt::format("set sign = {} in [gyro] of the profile", -profile.sign)};
  if (unit != nullptr) {
    const std::string sign = turned.empty() ? "" : fmt::format(", and sign = {}", -profile.sign);
    return {turned.empty() ? unit->why : turned + ", and " + unit->why,
            scale_line(profile, unit->factor) + sign};
  }
  if (const double lean_deg = lean_of(axes, axis); lean_deg > most_lean_deg)
    return {fmt::format("its axis leans by {:.0f} deg against the shaft's{}", lean_deg,
                        turned.empty() ? "" : ", and " + turned),
            turned.empty()
                ? "mount the gyro upright, or thermorig calibrate scale"
                : fmt::format("mount the gyro upright, or set sign = {} in [gyro] of the profile and "
                              "thermorig calibrate scale",
                              -profile.sign)};
  return {"its scale or its range is not as the profile says", "thermorig calibrate scale"};
}

Cause command_cause(double share, const ServoProfile& profile) {
  if (std::abs(share) < least_turning_share)
    return {"the servo does not turn: its supply, its signal wire, or what blocks it",
            "check the servo's supply and wiring"};
  if (share < 0.0)
    return {"the servo turns the other way than the profile says",
            "turn both round in the profile: sign in [gyro], mirrored in [camera]"};
  if (share < 1.0 || profile.kind == ServoKind::continuous)
    return {"a weak supply, too much load, or another servo than the profile's",
            "check the servo's supply and load; then thermorig calibrate scale"};
  return {fmt::format("another servo than the profile's: its travel may be {:.0f} deg",
                      share * profile.travel_deg),
          "set travel_deg in [servo] of the profile, or thermorig calibrate scale"};
}

Cause images_cause(double share, double tolerance, const CameraProfile& profile) {
  if (share < 0.0 && std::abs(share + 1.0) < tolerance)
    return {"the camera's image is mirrored otherwise than the profile says",
            fmt::format("set mirrored = {} in [camera] of the profile", !profile.mirrored)};
  if (std::abs(share) < 2.0 * least_turning_share)
    return {"the image stands still: the camera is not on the shaft, or sends one image again and again",
            "check the camera and its mounting"};
  for (const double other_deg : {55.0, 110.0})
    if (std::abs(profile.field_of_view_deg / other_deg / std::abs(share) - 1.0) < tolerance &&
        std::abs(profile.field_of_view_deg - other_deg) > 1.0)
      return {fmt::format("its lens is that of {:.0f} deg", other_deg),
              fmt::format("set field_of_view_deg = {:.0f} in [camera] of the profile", other_deg)};
  return {"its lens is not the profile's, or something near or moving fills the image",
          "thermorig calibrate lens"};
}

// ---- judgement ------------------------------------------------------------------------------------------

/// What may be believed of each by the profile: relative standard deviations.
struct Stated {
  double servo, gyro, lens;
};

Stated stated_by(const RigProfile& profile, const GyroErrors& errors) {
  const auto at_least = [](double uncertainty) { return std::max(uncertainty, least_scale_uncertainty); };
  return {at_least(profile.servo.scale_uncertainty),
          at_least(errors.scale.uncertainty / std::max(errors.scale.value, 1e-3)),
          std::hypot(at_least(profile.camera.pitch_scale_uncertainty), parallax)};
}

/// Relative tolerances count of the expected share, never of the one that is judged: what shows next to
/// nothing would else be next to certain.
bool contradict_by(const Estimate& a, const Estimate& b, double stated) {
  return std::abs(a.value - b.value) >
         contradiction_deviations * std::hypot(a.uncertainty, b.uncertainty, stated);
}

struct Outlier {
  Witness witness = Witness::none;
  bool between_gyro_and_images = false;  // the command agrees with either
};

Outlier outlier_of(const std::optional<Estimate>& gyro, const std::optional<Estimate>& images,
                   const Estimate& command, const Stated& stated) {
  const double scale = command.value;
  const auto against = [&](const std::optional<Estimate>& share, double of_it) {
    return share && contradict_by(*share, command, scale * std::hypot(of_it, stated.servo));
  };
  const bool gyro_off = against(gyro, stated.gyro), images_off = against(images, stated.lens);
  const double stated_apart = std::hypot(stated.gyro, stated.lens);
  const bool apart = gyro && images && contradict_by(*gyro, *images, scale * stated_apart);
  if (!gyro_off && !images_off) {  // a command that nobody trusts to that cannot tell who is right
    const bool nobody_tells = apart && stated.servo > stated_apart;
    return {nobody_tells ? Witness::undecided : Witness::none, nobody_tells};
  }
  if (!gyro || !images) return {Witness::undecided};
  if (!gyro_off) return {apart ? Witness::images : Witness::none};
  if (apart) return {images_off ? Witness::undecided : Witness::gyro};
  return {images_off ? Witness::command : Witness::undecided};  // the images agree with either of the two
}

/// Nothing where they were not looked at.
std::string images_text(const Witnesses& witnesses) {
  if (witnesses.images_share)
    return fmt::format(", the images {}", share_text(witnesses.images_share->value));
  if (witnesses.images_why_not.empty()) return "";
  return fmt::format(", and the images cannot say who is right ({})", witnesses.images_why_not);
}

Cause cause_of(Witness outlier, const Witnesses& witnesses, const Axes& axes, double tolerance,
               const RigProfile& profile) {
  if (outlier == Witness::command) return command_cause(witnesses.gyro_share->value, profile.servo);
  if (outlier == Witness::images || !witnesses.gyro_share)
    return images_cause(witnesses.images_share->value, tolerance, profile.camera);
  if (axes.saturated > most_saturated)
    return std::abs(witnesses.gyro_share->value) > profile.servo.scale * (1.0 + tolerance)
               ? Cause{"the gyro's readings are in a smaller unit than the profile says",
                       "state the gyro's unit or range in the profile"}
               : Cause{"the gyro is at the end of its range", "set a wider range of the gyro"};
  Cause cause = gyro_cause(axes, witnesses.gyro_share->value, profile.servo.scale, tolerance, profile.gyro);
  if (outlier == Witness::undecided) cause.why += "; or the servo does not turn as commanded";
  return cause;
}

std::string contradiction(Outlier found, const Witnesses& witnesses) {
  const Witness outlier = found.witness;
  const auto& [gyro, images] = std::tie(witnesses.gyro_share, witnesses.images_share);
  if (outlier == Witness::command)
    return fmt::format("the shaft turns at {} of the commanded speed, gyro and images agree",
                       share_text(gyro->value));
  if (outlier == Witness::images || !gyro)
    return fmt::format("images and command contradict: the images turn at {} of the commanded speed{}",
                       share_text(images->value),
                       gyro ? fmt::format(", the gyro at {}", share_text(gyro->value)) : "");
  return fmt::format("gyro and {} contradict: the gyro shows {} of the commanded speed{}",
                     found.between_gyro_and_images ? "images" : "command", share_text(gyro->value),
                     images_text(witnesses));
}

/// Fills in outlier, cause and remedy.
void judge(Witnesses& witnesses, const Axes& axes, const Stated& stated, const RigProfile& profile) {
  const auto axis = static_cast<std::size_t>(profile.gyro.axis);
  Outlier found =
      outlier_of(witnesses.gyro_share, witnesses.images_share, {profile.servo.scale, 0.0}, stated);
  if (found.witness == Witness::none && witnesses.gyro_share && axes.saturated > most_saturated)
    found.witness = Witness::gyro;
  const Witness outlier = found.witness;
  witnesses.outlier = outlier;
  if (outlier != Witness::none) {
    const double tolerance = contradiction_deviations * std::hypot(stated.servo, stated.gyro);
    const Cause cause = cause_of(outlier, witnesses, axes, tolerance, profile);
    witnesses.cause = fmt::format("{}; likely cause: {}", contradiction(found, witnesses), cause.why);
    witnesses.remedy = cause.remedy;
  } else if (const double lean_deg = lean_of(axes, axis);
             witnesses.gyro_share && axes.is_known && lean_deg > most_lean_deg) {
    witnesses.cause = fmt::format("the gyro's axis leans by {:.0f} deg against the shaft's", lean_deg);
    witnesses.remedy = "mount the gyro upright, or thermorig calibrate scale";
  }
}

}  // namespace

Witnesses compare_witnesses(std::span<const TimedServo> servo, std::span<const TimedGyro> gyro,
                            const GyroErrors& errors, const RigProfile& profile, ImagesShare images) {
  Witnesses witnesses;
  witnesses.images_share = images.share;
  witnesses.images_why_not = std::move(images.why_not);
  if (servo.empty()) return witnesses;
  const HostTime origin = servo.front().stamp.time;
  std::vector<Interval> legs = steady_intervals(servo, origin, false);
  std::erase_if(legs, [](const Interval& leg) { return leg.leg == 0; });
  const Axes axes = axes_of(legs, steady_intervals(servo, origin, true), gyro, origin);
  if (!gyro.empty()) {
    const GyroIntegral integral(gyro, errors, origin, GyroIntegral::Saturated::counts);
    const double bias_dps = errors.bias_dps ? errors.bias_dps->uncertainty : unknown_bias_dps;
    witnesses.gyro_share = reached_share(reached_speeds(legs, integral, bias_dps, profile.servo.kind),
                                         bias_dps, profile.servo.kind);
  }
  judge(witnesses, axes, stated_by(profile, errors), profile);
  return witnesses;
}

}  // namespace thermorig::fit
