// SPDX-License-Identifier: MIT
#pragma once

#include "thermorig/core/raw_recording.h"
#include "thermorig/core/run_all.h"
#include "thermorig/pipeline/pipeline.h"

namespace thermorig::fit {

/// First pass: what the bytes, their arrivals and the streams decoded from them say about the recording as a
/// whole: mode, missing frames, clocks, camera offset, gyro errors, servo response. Whatever cannot be known
/// is absent, and the report says why. `streams` are those of a Pipeline without fits over `raw`. What does
/// not hang on one another is handed to `run_all`; who does it makes no difference to the result.
pipeline::Fits fit_recording(const RawRecording& raw, pipeline::Streams streams,
                             const RunAll& run_all = in_turn);

}  // namespace thermorig::fit
