// SPDX-License-Identifier: MIT
#include "camera.h"

#include <algorithm>
#include <cmath>

#include "scenes.h"

namespace thermorig::simulation {
namespace {

constexpr double integration_step_s = 0.003125;
// The clock is an RC oscillator (data sheet, block diagram): it wanders by about 200 ppm over a minute.
constexpr double wander_rms = 200e-6;
constexpr double wander_time_s = 60.0;

// Reading 832 words at 1 MHz takes 15 ms; the rest is arithmetic. Differs from board to board.
constexpr double processing_shortest_s = 0.016;
constexpr double processing_longest_s = 0.024;
constexpr double processing_jitter_s = 0.002;

double refresh_period(const CameraConfig& config) {
  return 1.0 / (config.half_fresh ? config.output_rate_hz : 2.0 * config.output_rate_hz);
}

std::int64_t ns(double seconds) {
  return std::llround(seconds * 1e9);
}

}  // namespace

// A pixel's membrane follows what it sees as a first-order system. The data sheet does not state its time
// constant. What a pixel shows is thus older than its integration by that much: images cannot tell it from
// the bridge's own delay.
Camera::Camera(const CameraConfig& config, const Panorama& panorama, std::uint64_t seed)
    : config_(config),
      optics_(with_contrast(panorama, config.scene.contrast), FieldOfView::of_width(config.field_of_view_deg),
              config.mirrored),
      clock_(seed, "camera clock"),
      losses_(seed, "camera losses"),
      refresh_period_s_(refresh_period(config)),
      lag_s_(1e-3 * config.world.membrane_lag_ms),
      shown_ns_(ns(lag_s_) + ns(0.5 * std::abs(config.world.rolling_rows) * refresh_period_s_)),
      noise_(NoiseLevel::of(config.field_of_view_deg, 1.0 / refresh_period_s_), config.warm, seed,
             config.world),
      processing_s_(clock_.uniform(processing_shortest_s, processing_longest_s)),
      last_parity_(clock_.chance(0.5) ? 1U : 0U) {
  if (config.latency_s) processing_s_ = *config.latency_s - lag_s_;
  processing_s_ += 1e-3 * config.world.extra_latency_ms;
  if (FreeOptics::is_needed(config.world, config.scene))
    free_optics_.emplace(with_contrast(panorama, config.scene.contrast),
                         FieldOfView::of_width(config.field_of_view_deg), config.mirrored, config.world,
                         config.scene, seed);
}

void Camera::set_output_rate(double output_rate_hz) {
  const double period_s = refresh_period_s_;
  config_.output_rate_hz = output_rate_hz;
  refresh_period_s_ = refresh_period(config_);
  noise_.grow(std::sqrt(period_s / refresh_period_s_));
}

/// How long before the last row it is integrated.
std::int64_t Camera::row_offset_ns(std::size_t row) const {
  const double part = static_cast<double>(row) / (frame_rows - 1);
  const double rolling = config_.world.rolling_rows;
  return ns(refresh_period_s_ * (rolling > 0.0 ? rolling * (1.0 - part) : -rolling * part));
}

/// What the pixels see at a time, cut off where they are saturated.
void Camera::view(const Shaft& shaft, std::int64_t time_ns, PixelColumns& seen_c) {
  if (free_optics_) {
    RowYaws yaw_deg;
    for (std::size_t row = 0; row < frame_rows; ++row)
      yaw_deg[row] = shaft.angle_deg(time_ns - row_offset_ns(row));
    free_optics_->view(yaw_deg, 1e-9 * static_cast<double>(time_ns), seen_c);
  } else {
    optics_.view(shaft.angle_deg(time_ns), seen_c);
  }
  const auto saturation_c = static_cast<float>(config_.scene.saturation_c);
  for (float& temp_c : seen_c) temp_c = std::min(temp_c, saturation_c);
}

std::int64_t Camera::next_period_ns() {
  const double keep = std::exp(-refresh_period_s_ / wander_time_s);
  wander_ = keep * wander_ + clock_.normal(wander_rms * std::sqrt(1.0 - keep * keep));
  return ns(refresh_period_s_ / (1.0 + config_.clock_error + wander_));
}

/// The camera has been running before the rig's time begins: both halves hold readings of the scene at rest,
/// and a half is under exposure, begun some time ago.
void Camera::warm_up(const Shaft& shaft) {
  started_ = true;
  const double angle_deg = shaft.angle_deg(0);
  view(shaft, 0, lagged_c_);
  noise_.read_half(lagged_c_, 0, 0.0, frame_);
  noise_.read_half(lagged_c_, 1, 0.0, frame_);
  const std::int64_t age_ns = ns(clock_.uniform() * refresh_period_s_);
  shown_begin_.fill({-age_ns - next_period_ns() - shown_ns_, angle_deg});
  begin_half(-age_ns, {-age_ns - shown_ns_, angle_deg}, last_parity_ ^ 1U);
}

void Camera::begin_half(std::int64_t begin_ns, const ShaftMark& exposure_begin, unsigned parity) {
  const std::int64_t period_ns = next_period_ns();
  const int steps = static_cast<int>(std::ceil(static_cast<double>(period_ns) * 1e-9 / integration_step_s));
  half_ = {parity, begin_ns, begin_ns + period_ns, exposure_begin, steps, 0};
  sum_c_.fill(0.0F);
}

std::int64_t Camera::step_time_ns(int step) const {
  return half_.begin_ns + (half_.end_ns - half_.begin_ns) * (2 * step + 1) / (2 * half_.steps);
}

/// What is seen in the middle of a step stands for the whole of it; the membranes' mean over the step is
/// integrated.
void Camera::expose_step() {
  const double step_s = static_cast<double>(half_.end_ns - half_.begin_ns) * 1e-9 / half_.steps;
  const double follow = 1.0 - std::exp(-step_s / lag_s_);
  const auto followed = static_cast<float>(follow);
  const auto held = static_cast<float>(follow * lag_s_ / step_s);
  for (std::size_t i = 0; i < frame_pixels; ++i) {
    const float behind_c = lagged_c_[i] - seen_c_[i];
    sum_c_[i] += seen_c_[i] + held * behind_c;
    lagged_c_[i] -= followed * behind_c;
  }
  ++half_.steps_done;
}

/// In its place the one before, now and then.
void Camera::send_frame(const ShaftMark& exposure_end, std::vector<SimulatedFrame>& out) {
  frame_.sensor_temp_c = noise_.sensor_temp_c(static_cast<double>(half_.end_ns) * 1e-9);
  const double processing_s = processing_s_ + processing_jitter_s * clock_.uniform();
  const bool repeats = config_.world.repeated_frames > 0.0 && losses_.chance(config_.world.repeated_frames);
  if (!repeats || !sent_) sent_ = {frame_, shown_begin_[half_.parity ^ 1U], exposure_end, 0, half_.parity};
  sent_->ready_ns = half_.end_ns + ns(processing_s);
  out.push_back(*sent_);
}

/// A half that the bridge misses leaves the pixels as they were, and no frame is sent for it.
void Camera::finish_half(const ShaftMark& exposure_end, std::vector<SimulatedFrame>& out) {
  const bool is_lost = config_.world.lost_subpages > 0.0 && losses_.chance(config_.world.lost_subpages);
  if (!is_lost) {
    for (float& sum : sum_c_) sum /= static_cast<float>(half_.steps);
    noise_.read_half(sum_c_, half_.parity, static_cast<double>(half_.end_ns) * 1e-9, frame_);
    shown_begin_[half_.parity] = half_.exposure_begin;
    if (config_.half_fresh || half_.parity == last_parity_) send_frame(exposure_end, out);
  }
  begin_half(half_.end_ns, exposure_end, half_.parity ^ 1U);
}

std::vector<SimulatedFrame> Camera::follow(const Shaft& shaft) {
  std::vector<SimulatedFrame> out;
  if (!started_) warm_up(shaft);
  const std::int64_t known_ns = shaft.known_until_ns();
  while (true) {
    if (half_.steps_done < half_.steps) {
      const std::int64_t time_ns = step_time_ns(half_.steps_done);
      if (time_ns > known_ns) return out;
      view(shaft, time_ns, seen_c_);
      expose_step();
    } else {
      if (half_.end_ns > known_ns) return out;
      const std::int64_t shown_ns = half_.end_ns - shown_ns_;
      finish_half({shown_ns, shaft.angle_deg(shown_ns)}, out);
    }
  }
}

}  // namespace thermorig::simulation
