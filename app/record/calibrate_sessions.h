// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calibrate_text.h"
#include "options.h"
#include "thermorig/core/raw_recording.h"

namespace thermorig::app {

/// A session that was left out, and why.
struct SkippedSession {
  std::filesystem::path path;
  std::string reason;
};

/// What sessions of one rig say together.
struct MeasuredSessions {
  CalibrationResult result;
  std::vector<std::filesystem::path> paths;  // that took part
  std::vector<SkippedSession> skipped;
  RecordingHeader header;    // of the first that took part
  std::string measured_utc;  // "2026-07-25T14:35:12Z": when the newest of them began
};

/// Measures on each of `paths` what `options` ask for. Leaves out a session that cannot tell, and one that is
/// there twice. Throws Error(finished_lossy) that names the file if none can tell, Error(bad_usage) if the
/// sessions are of different rigs, and as session::read_session() does.
MeasuredSessions measure_sessions(const CalibrateOptions& options,
                                  const std::vector<std::filesystem::path>& paths);

/// The angle between the marks, where nobody named it.
inline constexpr double full_turn_deg = 360.0;

}  // namespace thermorig::app
