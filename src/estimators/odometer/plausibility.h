// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>

#include "heading_filter.h"
#include "thermorig/core/profile.h"
#include "tracker.h"

namespace thermorig::odometer {

/// Of the mean square of innovations, of which one counts with `most` at most.
struct NisBounds {
  double settled, fits, unfit, lost;  // not trusted from `unfit` on until it `fits`
  double most;
};
inline constexpr NisBounds nis_at_rest{2.0, 2.0, 3.0, lost_nis, most_nis};  // where nothing moves but the rig
// There the share of the halves counts that do not fit: how badly they do tells of what moves.
inline constexpr NisBounds nis_in_traffic{4.5, 4.0, 5.5, 7.0, 9.0};
constexpr const NisBounds& nis_bounds(bool things_move) {
  return things_move ? nis_in_traffic : nis_at_rest;
}

/// What profiles say of both sensors, before anything was measured.
inline Priors priors_of(const GyroProfile& gyro, const CameraProfile& camera) {
  Priors priors;
  priors.bias_dps = gyro.bias_dps;
  priors.bias_sigma_dps = gyro.later_bias_sigma_dps();
  priors.scale = gyro.scale;
  priors.scale_sigma = std::max(0.002, gyro.scale_uncertainty);
  priors.latency_sigma_s =
      std::hypot(0.002, gyro.link.latency_uncertainty_s, camera.link.latency_uncertainty_s);
  return priors;
}

/// Whether the gyro that a start has learnt is one that a data sheet knows: a map that closes falsely makes
/// it another, by 7 to 9 % of its scale, and by 6 % where things move.
inline bool is_plausible(const HeadingFilter& learnt, const Priors& priors, bool things_move) {
  constexpr double data_sheet_scale_sigma = 0.03;  // at least, whatever a profile says
  const double most = (things_move ? 1.8 : 2.2) * std::max(data_sheet_scale_sigma, priors.scale_sigma);
  return std::abs(learnt.scale_factor() - priors.scale) < most;
}

/// What a pass has learnt differs by less than so much from what it began with: another one would learn the
/// same.
struct Nearness {
  double bias_dps, scale, latency_s;
};
inline bool is_near(const HeadingFilter& learnt, const Priors& begun_with, const Nearness& limits) {
  return std::abs(learnt.bias_dps() - begun_with.bias_dps) < limits.bias_dps &&
         std::abs(learnt.scale_factor() - begun_with.scale) < limits.scale &&
         std::abs(learnt.latency_s() - begun_with.latency_s) < limits.latency_s;
}

/// A scale that no data sheet knows is believed when a second start, of other halves, has learnt the same:
/// maps that close falsely do so each in its own way.
class RefusedScale {
 public:
  RefusedScale() = default;

  /// Of a start that came to an end at `now_s`.
  void refuse(double scale, double now_s) {
    if (!is_same(scale)) *this = {scale, now_s};
  }
  /// By a start whose halves came from `first_s` on.
  bool is_confirmed(double scale, double first_s) const { return is_same(scale) && first_s > until_s_; }

 private:
  static constexpr double same = 0.004;
  RefusedScale(double scale, double until_s) : scale_(scale), until_s_(until_s) {}
  bool is_same(double scale) const { return std::abs(scale - scale_) < same; }

  double scale_ = 0.0, until_s_ = 0.0;  // 0: none
};

/// Where a start has not learnt one, rows are exposed in another order than the one that is tried.
inline bool has_usual_latency(const HeadingFilter& learnt, const Priors& priors) {
  constexpr double most_sigmas = 2.5;
  return std::abs(learnt.latency_s() - priors.latency_s) < most_sigmas * priors.latency_sigma_s;
}

}  // namespace thermorig::odometer
