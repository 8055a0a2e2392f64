// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "simulation/camera.h"

namespace thermorig::simulation {

/// What one computes of a motionless recording: the same figures as for recordings of real cameras.
struct StillStatistics {
  double noise_median_k = 0.0;  // temporal standard deviation, median over pixels
  double noise_centre_k = 0.0;  // median over the middle 8 x 8 pixels
  double noise_corner_k = 0.0;  // median over the four 3 x 3 corners
  double lag_one = 0.0;         // autocorrelation of a pixel's differences, same chess half: white is -0.5
  double common_mode_k = 0.0;   // standard deviation of a half's mean
  double pattern_k = 0.0;       // pixel minus its four neighbours, robust
  double chess_offset_k = 0.0;  // even half minus odd half
  double spatial_k = 0.0;       // standard deviation over the mean view, dead pixels left out
  double low_c = 0.0, high_c = 0.0;  // 1st and 99th percentile of the temperatures
  double repeat_correlation = 0.0;   // of full images two frames apart
};

StillStatistics still_statistics(const std::vector<SimulatedFrame>& frames);

double mean_of(const std::vector<double>& values);
double median_of(std::vector<double> values);
double deviation_of(const std::vector<double>& values);
double quantile_of(std::vector<double> values, double part);

}  // namespace thermorig::simulation
