// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "thermorig/core/chunk.h"
#include "thermorig/core/profile.h"
#include "thermorig/core/raw_recording.h"
#include "thermorig/core/run_all.h"
#include "thermorig/core/sample.h"
#include "thermorig/pipeline/pipeline.h"

namespace thermorig::pipeline {

/// One message of a device, and when its first byte began on the wire.
struct ScriptedMessage {
  Device device = Device::camera;
  HostTime begin{};
  std::vector<std::uint8_t> bytes;
};

/// Messages of the three devices, made by hand: a sweep of +100 deg/s (leg 7) from 1 s to 4 s, rests around
/// it, half-fresh frames, and a gyro whose y axis shows the turn with the opposite sign.
struct ScriptedRecording {
  RigProfile profile;
  std::vector<ScriptedMessage> messages;

  explicit ScriptedRecording(double duration_s = 5.0, bool half_fresh = true);
};

/// Cuts each message into chunks of `chunk_bytes`; a chunk arrives when its last byte is through.
std::vector<Chunk> chunks_within_messages(const ScriptedRecording& recording, std::size_t chunk_bytes);

/// Cuts each device's stream into chunks of pseudo-random length, across messages.
std::vector<Chunk> chunks_across_messages(const ScriptedRecording& recording, unsigned seed,
                                          std::size_t longest);

struct Result {
  std::vector<Measurement> measurements;
  std::vector<LabelledSample> samples;  // of them
  Streams streams;
  PerDevice<wire::Counters> counters;
};
/// `sent`: to the servo, in order of time.
Result run(const RigProfile& profile, const std::vector<Chunk>& chunks, const Fits& fits = {},
           const RawStream& sent = {});

/// What the chunks say as a whole: run() without fits, then fit().
Fits first_pass(const RigProfile& profile, const std::vector<Chunk>& chunks, const RawStream& sent = {},
                const RunAll& run_all = in_turn);

}  // namespace thermorig::pipeline
