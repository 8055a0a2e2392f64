// SPDX-License-Identifier: MIT
#include "reports.h"

#include <algorithm>
#include <cmath>

namespace thermorig::odometer {

GyroProfile data_sheet_gyro() {
  GyroProfile gyro;
  gyro.bias_uncertainty_dps = 10.0;
  gyro.bandwidth_hz = no_low_pass_hz;
  return gyro;
}

std::vector<Report> reports_of(const std::vector<Seen>& all, const GyroProfile& gyro,
                               const CameraProfile& camera) {
  Odometer odometer(gyro, camera);
  std::vector<Report> reports;
  for (const Seen& seen : all) reports.push_back(odometer.add(seen.frame, seen.gyro));
  return reports;
}

std::size_t at(double time_s) {
  return static_cast<std::size_t>(time_s / 0.125) - 2;
}

double off_deg(const Room& room, const std::vector<Report>& reports, double time_s) {
  return reports[at(time_s)].heading_deg - room.angle_deg(0.125 * static_cast<double>(at(time_s) + 2));
}

double silent_s(const Room& room, const std::vector<Report>& reports, double from_s) {
  const double origin_deg = off_deg(room, reports, from_s);
  double silent_s = 0.0, longest_s = 0.0;
  for (double time_s = from_s; time_s < room.duration_s - 0.5; time_s += 0.125) {
    const bool is_off = std::abs(off_deg(room, reports, time_s) - origin_deg) > 2.0;
    silent_s = is_off && reports[at(time_s)].state == EstimateState::good ? silent_s + 0.125 : 0.0;
    longest_s = std::max(longest_s, silent_s);
  }
  return longest_s;
}

double share_tracked(const std::vector<Report>& reports, double from_s) {
  const auto tracked = std::count_if(reports.begin() + static_cast<long>(at(from_s)), reports.end(),
                                     [](const Report& one) { return one.state == EstimateState::good; });
  return static_cast<double>(tracked) / static_cast<double>(reports.size() - at(from_s));
}

}  // namespace thermorig::odometer
