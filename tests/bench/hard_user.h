// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "rig/simulated_bus.h"
#include "thermorig/rig/recording/recording.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::bench {

/// What somebody has before him: a rig in its world. `calibrated_in` is the world at the time of the
/// calibrations: another one where something has changed since.
struct HardCase {
  std::uint64_t seed = 1;
  std::string environment = "laboratory";
  std::string world = "honest";
  std::string calibrated_in = "honest";
  std::string camera = "half";       // of simulation::camera_kinds()
  bool has_encoder = false;          // an AS5600 on the shaft, which is calibrated as well
  std::string servo = "servo-link";  // its protocol; what measures its shaft is calibrated as well
};

/// A calibration that said that it cannot tell: what it would have measured stays an assumption.
struct RefusedCalibration {
  std::string name;
  std::string why;
};

/// What came of it.
struct HardRecording {
  std::vector<RefusedCalibration> refused_calibrations;
  std::string refusal;          // of the recording itself, and then there is no session; else empty
  rig::RecordingResult result;  // as `record` says it
  std::optional<session::Session> session;
  std::unique_ptr<rig::test::SimulatedBus> bus;  // holds the truth of the recording
};

/// As a user does with the program: `calibrate orientation`, `scale` and `latency`, each kept in the profile
/// that the next one takes, then `record --plan paper --fast` with it; the session is read back from its
/// file.
HardRecording use(const HardCase& hard);

}  // namespace thermorig::bench
