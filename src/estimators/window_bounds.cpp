// SPDX-License-Identifier: MIT
#include "thermorig/estimators/window_bounds.h"

#include <algorithm>
#include <cmath>

#include "thermorig/core/statistics.h"
#include "thermorig/estimators/likelihood/rate_bound.h"

namespace thermorig::estimators {

namespace {

constexpr std::size_t odometer_place = 0, gyro_place = 1, likelihood_place = 2;
const std::vector<std::string>& needed() {
  static const std::vector<std::string> names{"odometer", "gyro", "thermal-likelihood"};
  return names;
}

constexpr double most_gap_s = 0.02;  // between exposures that follow each other

float typical(std::vector<float> values) {
  std::erase_if(values, [](float value) { return !std::isfinite(value); });
  return values.empty() ? RateEstimate::not_known : reordering_median(values);
}

}  // namespace

WindowBounds::WindowBounds(const RigProfile& profile)
    : camera_(profile.camera), bank_(needed(), std::nullopt, profile) {}

void WindowBounds::take(const TimedFrame& frame, std::span<const RateEstimate> estimates) {
  const RateEstimate& odometer = estimates[odometer_place];
  Seen seen{.half = frame.half, .end = frame.exposure_end};
  seen.newest = frame.halves_by_time()[1];
  seen.is_new = frame.is_fresh(seen.newest) && !frame.late && !frame.stale && !frame.stands_in &&
                !frame.resync_before && frame.missing_before == 0;
  seen.gyro_dps = estimates[gyro_place].rate_dps;
  seen.heading_deg = odometer.angle_deg;
  seen.is_tracked = odometer.state == EstimateState::good;
  seen.bias_dps = odometer.values[0];
  seen.scale = odometer.values[1];
  seen.noise_c = estimates[likelihood_place].values[0];
  seen_.push_back(seen);
}

/// Where the odometer was not sure yet, the gyro says from later on where the camera looked.
std::vector<WindowBounds::Seen> WindowBounds::with_headings() const {
  std::vector<Seen> all = seen_;
  for (std::size_t i = all.size(); i-- > 1;) {
    const Seen& later = all[i];
    if (all[i - 1].is_tracked || !later.is_tracked) continue;
    const double step_s = to_s(later.end - all[i - 1].end);
    all[i - 1].heading_deg =
        later.heading_deg - (double{later.gyro_dps} - double{later.bias_dps}) / double{later.scale} * step_s;
    all[i - 1].bias_dps = later.bias_dps;
    all[i - 1].scale = later.scale;
    all[i - 1].is_tracked = std::isfinite(all[i - 1].heading_deg);
  }
  return all;
}

std::vector<float> WindowBounds::bounds_dps(int frames) const {
  std::vector<float> bounds(seen_.size(), RateEstimate::not_known);
  const std::vector<float> image_c = bank_.odometer()->map_image_c();
  if (image_c.empty()) return bounds;
  const std::vector<Seen> all = with_headings();
  std::vector<float> noises;
  for (const Seen& one : all) noises.push_back(one.noise_c);
  const float noise_c = typical(noises);
  if (!(noise_c > 0.0F)) return bounds;
  std::vector<likelihood::ExposedHalf> halves;
  std::size_t in_a_row = 0;
  const auto count = static_cast<std::size_t>(frames);
  for (std::size_t i = 0; i < all.size(); ++i) {
    in_a_row = all[i].is_new ? in_a_row + 1 : 0;
    if (in_a_row <= count || !all[i].is_tracked || !all[i + 1 - count].is_tracked) continue;
    const Seen& oldest = all[i + 1 - count];
    const auto add = [&](const Seen& one, std::size_t parity) {
      const HalfExposure& half = one.half[parity];
      if (!halves.empty() && to_s(half.begin - all[i].end) < halves.back().end_s - most_gap_s) return;
      halves.push_back(
          {static_cast<unsigned>(parity), to_s(half.begin - all[i].end), to_s(half.end - all[i].end)});
    };
    halves.clear();
    for (std::size_t k = i + 1 - count; k <= i; ++k) {
      add(all[k], all[k].newest ^ 1U);
      add(all[k], all[k].newest);
    }
    const double length_s = halves.back().end_s - halves.front().begin_s;
    const double step_s = to_s(all[i].end - oldest.end);
    // Of one frame: over the gyro's own mean. Of more: what the heading turned by.
    const double turned_dps =
        step_s > 0.0 ? (all[i].heading_deg - oldest.heading_deg) / step_s
                     : (double{all[i].gyro_dps} - double{all[i].bias_dps}) / double{all[i].scale};
    const likelihood::BoundedWindow window{.halves = halves,
                                           .heading_deg = all[i].heading_deg - 0.5 * turned_dps * length_s,
                                           .rate_dps = turned_dps,
                                           .noise_c = double{noise_c}};
    bounds[i] = static_cast<float>(likelihood::rate_bound_dps(window, {image_c}, camera_));
  }
  return bounds;
}

}  // namespace thermorig::estimators
