// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "thermorig/learning/interchange/sink.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::interchange {

/// An angle at a time, of something that turns about the servo's axis.
struct AngleAt {
  HostTime time{};
  double angle_deg = 0.0;
};

/// What one thing did over a recording.
struct Trajectory {
  std::string name;  // "shaft", "measured", or of the table of estimators
  // At the end of each frame's exposure where it is known; measured: of each reading.
  std::vector<AngleAt> angles;
};

/// The shaft by the servo's model, as a sensor on it measured it if there is one, then each estimator: those
/// of a live run as it showed them, else all that need no network. Each counts from an origin of its own.
std::vector<Trajectory> trajectories_of(const session::Session& session);

/// A line each: "t x y z qx qy qz qw", t in seconds of Unix time, no translation, turned about z. Throws as
/// the sink does.
void write_tum(const RecordingHeader& header, const Trajectory& trajectory, Sink& sink);

}  // namespace thermorig::interchange
