// SPDX-License-Identifier: MIT
#include "camera.h"

#include <cmath>

namespace thermorig::simulation {
namespace {

constexpr double integration_step_s = 0.003125;
// A pixel's membrane follows what it sees as a first-order system. The data sheet does not state its time
// constant. What a pixel shows is thus older than its integration by that much: images cannot tell it from
// the bridge's own delay.
constexpr double thermal_lag_s = 0.012;
constexpr std::int64_t thermal_lag_ns = 12'000'000;

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

Camera::Camera(const CameraConfig& config, const Panorama& panorama, std::uint64_t seed)
    : config_(config),
      optics_(panorama, FieldOfView::of_width(config.field_of_view_deg), config.mirrored),
      clock_(seed, "camera clock"),
      refresh_period_s_(refresh_period(config)),
      noise_(NoiseLevel::of(config.field_of_view_deg, 1.0 / refresh_period_s_), config.warm, seed),
      processing_s_(clock_.uniform(processing_shortest_s, processing_longest_s)),
      last_parity_(clock_.chance(0.5) ? 1U : 0U) {
  if (config.latency_s) processing_s_ = *config.latency_s - thermal_lag_s;
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
  optics_.view(angle_deg, lagged_c_);
  noise_.read_half(lagged_c_, 0, 0.0, frame_);
  noise_.read_half(lagged_c_, 1, 0.0, frame_);
  const std::int64_t age_ns = ns(clock_.uniform() * refresh_period_s_);
  older_begin_ = {-age_ns - next_period_ns() - thermal_lag_ns, angle_deg};
  begin_half(-age_ns, {-age_ns - thermal_lag_ns, angle_deg}, last_parity_ ^ 1U);
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
void Camera::expose_step(double angle_deg) {
  optics_.view(angle_deg, seen_c_);
  const double step_s = static_cast<double>(half_.end_ns - half_.begin_ns) * 1e-9 / half_.steps;
  const double follow = 1.0 - std::exp(-step_s / thermal_lag_s);
  const auto followed = static_cast<float>(follow);
  const auto held = static_cast<float>(follow * thermal_lag_s / step_s);
  for (std::size_t i = 0; i < frame_pixels; ++i) {
    const float behind_c = lagged_c_[i] - seen_c_[i];
    sum_c_[i] += seen_c_[i] + held * behind_c;
    lagged_c_[i] -= followed * behind_c;
  }
  ++half_.steps_done;
}

void Camera::finish_half(const ShaftMark& exposure_end, std::vector<SimulatedFrame>& out) {
  for (float& sum : sum_c_) sum /= static_cast<float>(half_.steps);
  const double time_s = static_cast<double>(half_.end_ns) * 1e-9;
  noise_.read_half(sum_c_, half_.parity, time_s, frame_);
  if (config_.half_fresh || half_.parity == last_parity_) {
    frame_.sensor_temp_c = noise_.sensor_temp_c(time_s);
    const double processing_s = processing_s_ + processing_jitter_s * clock_.uniform();
    out.push_back({frame_, older_begin_, exposure_end, half_.end_ns + ns(processing_s)});
  }
  older_begin_ = half_.exposure_begin;
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
      expose_step(shaft.angle_deg(time_ns));
    } else {
      if (half_.end_ns > known_ns) return out;
      const std::int64_t shown_ns = half_.end_ns - thermal_lag_ns;
      finish_half({shown_ns, shaft.angle_deg(shown_ns)}, out);
    }
  }
}

}  // namespace thermorig::simulation
