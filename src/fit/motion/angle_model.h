// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "half_view.h"

namespace thermorig::motion {

/// What about the angles of the halves may differ from what stamps and gyro say.
enum Parameter : std::size_t {
  offset_s = 0,         // the camera is so much later than its stamps say
  bias_dps = 1,         // of the gyro, in the middle of the halves
  drift_dps_per_s = 2,  // of that bias
  scale = 3,            // gyro's rate per true rate
  parameter_count = 4
};
using Parameters = Eigen::Matrix<double, parameter_count, 1>;
using Matrix = Eigen::Matrix<double, parameter_count, parameter_count>;

/// What is known of the parameters beforehand.
struct Prior {
  Parameters mean{0.0, 0.0, 0.0, 1.0};
  Parameters uncertainty = Parameters::Zero();
};

/// The angle from which a half saw the surroundings, for any parameters: mean over its exposure of the gyro's
/// integral, corrected. Angles count from the middle of what the halves cover, times from their middle.
class AngleModel {
 public:
  AngleModel(std::span<const HalfView> views, const AngleTrack& track, const Prior& prior);

  /// From now on all parameters have that offset: looking exposures up takes longer than all else here.
  void look_from(double offset);

  /// Of the view with that index.
  double angle_deg(std::size_t index, const Parameters& parameters) const;
  /// Its derivative by each parameter.
  Parameters change(std::size_t index, const Parameters& parameters) const;

  /// From the middle to either end, with the parameters as they are known beforehand.
  double reach_deg() const { return reach_deg_; }

 private:
  struct Exposure {
    double since_s = 0.0;  // its middle
    TurnPath::Mean mean;
  };

  std::span<const HalfView> views_;
  const TurnPath& path_;
  double offset_s_ = 0.0;
  std::vector<Exposure> exposures_;  // of the views, with that offset
  double middle_s_ = 0.0;
  double middle_deg_ = 0.0;
  double reach_deg_ = 0.0;
};

}  // namespace thermorig::motion
