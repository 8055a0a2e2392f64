// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "room.h"
#include "thermorig/estimators/odometer/odometer.h"

namespace thermorig::odometer {

inline constexpr double no_low_pass_hz = 8000.0;

/// A gyro of whose bias and scale a data sheet tells, and the lens of the room.
GyroProfile data_sheet_gyro();

/// What an odometer says after each frame.
std::vector<Report> reports_of(const std::vector<Seen>& all, const GyroProfile& gyro = data_sheet_gyro(),
                               const CameraProfile& camera = {});

/// Of the frame that ends at a time, among all.
std::size_t at(double time_s);

/// Heading less the shaft's angle.
double off_deg(const Room& room, const std::vector<Report>& reports, double time_s);

/// For how long at most it tracked and was more than 2 degrees off where it was at `from_s`.
double silent_s(const Room& room, const std::vector<Report>& reports, double from_s);

/// Of the frames since a time.
double share_tracked(const std::vector<Report>& reports, double from_s);

}  // namespace thermorig::odometer
