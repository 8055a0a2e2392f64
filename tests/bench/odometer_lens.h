// SPDX-License-Identifier: MIT
#pragma once

#include <optional>

#include "odometer_recording.h"
#include "thermorig/rig/calibration/calibration.h"

namespace thermorig::bench {

/// What `calibrate lens` makes of a rig.
struct CalibratedLens {
  std::optional<calibration::LensResult> result;  // none: refused
  RigProfile profile;                             // as it is used then
  double pitch_scale = 1.0, distortion = 0.0;     // true ones
};

/// Drives the calibration's plan on the rig of the case, measures, and writes a profile.
CalibratedLens calibrate_lens(const OdometerCase& wanted);

}  // namespace thermorig::bench
