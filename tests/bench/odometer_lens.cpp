// SPDX-License-Identifier: MIT
#include "odometer_lens.h"

#include <utility>

#include "thermorig/core/error.h"
#include "thermorig/rig/recording/finalise.h"

namespace thermorig::bench {

CalibratedLens calibrate_lens(const OdometerCase& wanted) {
  const simulation::VirtualRigConfig config = rig_of(wanted);
  RigProfile profile = config.profile;
  CalibratedLens lens{.pitch_scale = 1.0 + config.world.camera.pitch_error,
                      .distortion = config.world.camera.distortion};
  const rig::SweepPlan plan =
      rig::calibration_plan(rig::CalibrationKind::lens, profile.servo, profile.camera);
  try {
    lens.result = calibration::measure_lens(rig::build_session(drive(wanted, plan).raw));
    calibration::apply(*lens.result, "2026-01-01T00:00:00Z", profile);
  } catch (const Error& refusal) {
    if (refusal.code() != ExitCode::finished_lossy) throw;
  }
  lens.profile = profile;
  return lens;
}

}  // namespace thermorig::bench
