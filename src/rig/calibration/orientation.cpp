// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <vector>

#include "thermorig/core/error.h"
#include "thermorig/core/statistics.h"
#include "thermorig/fit/motion/panorama_fit.h"
#include "thermorig/fit/shaft/gyro_errors.h"
#include "thermorig/rig/calibration/calibration.h"

namespace thermorig::calibration {

namespace {

constexpr double least_correlation = 0.7;
constexpr double least_lead = 0.2;  // of the best axis over the next one, as a share of it
constexpr double longest_gap_s = 0.1;
constexpr double least_moving_dps = 5.0;

[[noreturn]] void refuse_orientation(const std::string& what, const std::string& advice) {
  throw Error(ExitCode::finished_lossy, what, "calibrate orientation", advice);
}

/// The commanded speed at times that only grow; none where telemetry does not reach.
class CommandedRate {
 public:
  explicit CommandedRate(std::span<const TimedServo> servo) : servo_(servo) {}
  std::optional<double> at(HostTime time) {
    while (next_ < servo_.size() && servo_[next_].stamp.time <= time) ++next_;
    if (next_ == 0 || next_ == servo_.size()) return std::nullopt;
    const TimedServo& before = servo_[next_ - 1];
    const TimedServo& after = servo_[next_];
    const double span_s = to_s(after.stamp.time - before.stamp.time);
    if (span_s > longest_gap_s) return std::nullopt;
    const double share = to_s(time - before.stamp.time) / span_s;
    return before.state.rate_dps + share * (after.state.rate_dps - before.state.rate_dps);
  }

 private:
  std::span<const TimedServo> servo_;
  std::size_t next_ = 0;
};

}  // namespace

GyroAxis measure_axis(const session::Session& session) {
  std::array<LineFit, 3> axes;  // of commanded and measured speed
  CommandedRate commanded(session.servo);
  const HostDuration delay = from_s(session.sync.servo.delay_s);
  for (const TimedGyro& sample : session.gyro) {
    const auto rate_dps = commanded.at(sample.stamp.time - delay);
    if (!rate_dps) continue;
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (std::isfinite(sample.reading.rate_dps[axis]))
        axes[axis].add(*rate_dps, sample.reading.rate_dps[axis]);
  }
  // By how much of the turning it shows: an axis across shows a percent of it, by its data sheet, and follows
  // that as well as the best one does.
  double moving_dps = 0.0, most = 0.0, next = 0.0;
  GyroAxis best;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    moving_dps =
        std::max(moving_dps, std::sqrt(axes[axis].squares_x() / std::max(1.0, axes[axis].weights())));
    const double shown = std::abs(axes[axis].slope());
    next = std::max(next, std::min(shown, most));
    if (shown <= most) continue;
    most = shown;
    const double followed = axes[axis].correlation();
    best = {static_cast<int>(axis), followed < 0 ? -1 : 1, shown, std::abs(followed)};
  }
  if (moving_dps < least_moving_dps)
    refuse_orientation("the servo hardly moved",
                       "sweeps in both directions: `thermorig calibrate orientation` drives them");
  if (best.correlation < least_correlation || most - next < least_lead * most)
    refuse_orientation(
        fmt::format("no axis of the gyro turns with the servo (the best follows it by {:.2f} of 1, and shows "
                    "{:.2f} of it; the next one {:.2f})",
                    best.correlation, most, next),
        "fix the gyro to the arm, with one of its axes along the servo's; is the servo's supply on?");
  return best;
}

namespace {

/// The gyro as it would have been decoded with that axis and sign.
std::vector<TimedGyro> about(const std::vector<TimedGyro>& gyro, std::size_t axis, int sign) {
  std::vector<TimedGyro> turned = gyro;
  for (TimedGyro& sample : turned) sample.rate_dps = static_cast<float>(sign) * sample.reading.rate_dps[axis];
  return turned;
}

}  // namespace

OrientationResult measure_orientation(const session::Session& session) {
  const GyroAxis axis = measure_axis(session);
  GyroProfile profile = session.raw.header.profile.gyro;
  profile.axis = axis.axis;
  profile.sign = axis.sign;
  const std::vector<TimedGyro> gyro = about(session.gyro, static_cast<std::size_t>(axis.axis), profile.sign);
  const GyroErrors errors = fit::fit_gyro_errors(gyro, session.servo, profile);
  const CameraProfile& camera = session.raw.header.profile.camera;
  const motion::Orientation image =
      motion::orientation(session.frames, gyro, {camera.lens_width_deg(), camera.mirrored}, errors);
  if (!image.mirrored || !(image.contrast > 0.0))
    refuse_orientation(
        "the image's direction cannot be measured: " + image.why_not,
        "point the camera at something with warm and cold edges, and see that the lens is free");
  return {.gyro_axis = profile.axis,
          .gyro_sign = profile.sign,
          .correlation = axis.correlation,
          .mirrored = *image.mirrored,
          .contrast = image.contrast};
}

}  // namespace thermorig::calibration
