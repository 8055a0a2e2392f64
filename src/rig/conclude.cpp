// SPDX-License-Identifier: MIT
#include <algorithm>

#include "thermorig/rig/finalise.h"
#include "thermorig/rig/recording.h"

namespace thermorig::rig {

namespace {

void say_how_it_ended(RecordingResult& result, const Recording& recording) {
  if (recording.failure()) {
    result.exit = ExitCode::device_lost;
    result.message = recording.failure()->where() + ": " + recording.failure()->what_happened();
    result.advice = recording.failure()->advice();
  } else if (recording.stopped()) {
    result.exit = ExitCode::interrupted;
    result.message = "stopped on request; everything up to then is in the session";
  } else if (result.quality.verdict == "bad") {
    result.exit = ExitCode::finished_lossy;
    result.message = "the plan was finished, but its quality is bad";
    result.advice = "thermorig inspect " + result.session.string();
  }
}

}  // namespace

RecordingResult conclude(Recording& recording, HostTime now) {
  if (!recording.sweep_began() && recording.failure()) {
    const Error failure = *recording.failure();
    recording.discard(now);
    throw failure;
  }
  const SessionFile file = recording.close(now);
  const session::Session session = finalise(file.journal, file.session);
  RecordingResult result;
  result.acquisition = file.acquisition;
  result.session = file.session;
  result.state = session.state;
  result.quality = session::quality_of(session);
  result.duration_s = to_s(now - session.raw.header.time_reference);
  say_how_it_ended(result, recording);
  return result;
}

}  // namespace thermorig::rig
