// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "odometer_judge.h"

namespace thermorig::bench {

/// Something that an odometer may meet, and what it must do then.
struct Stress {
  std::string name;
  std::string world = "honest";
  double field_of_view_deg = 55.0;
  JudgedRun run;
  double worst_deg = 3.0;                                 // or it says that it is not to be trusted
  odometer::RowOrder rows = odometer::RowOrder::at_once;  // that it should find, if its run tells them
};

std::vector<Stress> odometer_stresses();

}  // namespace thermorig::bench
