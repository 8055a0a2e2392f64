// SPDX-License-Identifier: MIT
// Any bytes, in any chunks, from the three devices, at any times that do not run backwards: nothing crashes,
// every camera frame gives exactly one sample, and what a sample claims holds together.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "../support/telemetry_bytes.h"
#include "thermorig/fit/fit.h"
#include "thermorig/pipeline/pipeline.h"
#include "thermorig/sensors/wire/device_bytes.h"

namespace {

using namespace thermorig;

void require(bool holds) {
  if (!holds) std::abort();
}

/// Reads the fuzzer's input as a script of chunks; beyond its end there are zeros.
class Script {
 public:
  Script(const std::uint8_t* data, std::size_t size) : rest_(data, size) {}
  bool done() const { return rest_.empty(); }

  std::uint8_t byte() { return bytes(1).front(); }
  std::int16_t word() {
    const auto two = bytes(2);
    return static_cast<std::int16_t>(two[0] << 8 | two[1]);
  }
  std::vector<std::uint8_t> bytes(std::size_t count) {
    const std::size_t taken = std::min(count, rest_.size());
    std::vector<std::uint8_t> result(rest_.begin(), rest_.begin() + static_cast<std::ptrdiff_t>(taken));
    result.resize(count);
    rest_ = rest_.subspan(taken);
    return result;
  }

 private:
  std::span<const std::uint8_t> rest_;
};

std::vector<std::uint8_t> good_frame(Script& script) {
  ThermalFrame frame;
  const auto fill = script.bytes(4);
  for (std::size_t i = 0; i < frame_pixels; ++i)
    frame.temp_c[i] = static_cast<float>(fill[subpage_of(i / frame_columns, i % frame_columns)]);
  frame.temp_c[fill[2]] = static_cast<float>(fill[3]) - 128.0F;
  return wire::camera_frame(frame);
}

std::vector<std::uint8_t> good_gyro(Script& script) {
  const auto packet = wire::witmotion_gyro_packet({script.word(), script.word(), script.word()}, 25.0F);
  return {packet.begin(), packet.end()};
}

std::vector<std::uint8_t> good_telemetry(Script& script) {
  ServoState state;
  const std::uint8_t sequence = script.byte();
  state.mcu_us = static_cast<std::uint32_t>(script.word()) << 16U;
  state.angle_deg = 0.1 * script.word();
  state.rate_dps = 0.01 * script.word();
  state.motion = static_cast<ServoMotion>(script.byte() % 5);
  state.fault = static_cast<ServoFault>(script.byte() % 16 == 0);
  state.leg = script.byte() % 4;
  return test::telemetry_bytes(sequence, state);
}

std::vector<std::uint8_t> good_message(Device device, Script& script) {
  switch (device) {
    case Device::camera:
      return good_frame(script);
    case Device::gyro:
      return good_gyro(script);
    case Device::servo:
      break;
  }
  return good_telemetry(script);
}

/// An item of the script: bits 0..1 device, bit 2 raw bytes or a good message, bit 3 cuts it, the rest time.
Chunk next_chunk(Script& script, HostTime& now) {
  constexpr std::array<double, 16> pauses_s{0,     0.0001, 0.001, 0.005, 0.01, 0.02, 0.05, 0.1,
                                            0.125, 0.126,  0.2,   0.5,   1.0,  2.0,  60.0, 5000.0};
  const std::uint8_t item = script.byte();
  now += from_s(pauses_s[item >> 4U]);
  Chunk chunk{all_devices[(item & 3U) % device_count], now, {}};
  chunk.bytes = (item & 4U) != 0 ? script.bytes(script.byte()) : good_message(chunk.device, script);
  if ((item & 8U) != 0) chunk.bytes.resize(chunk.bytes.size() * script.byte() / 256U);
  return chunk;
}

void check(const LabelledSample& sample, std::uint32_t index) {
  require(sample.frame_index == index);
  require(sample.exposure_begin <= sample.time && sample.time <= sample.exposure_end);
  require((sample.reason_bits & ~computed_bits) == 0);
  require(sample.valid == ((sample.reason_bits & ~warning_bits) == 0));
  require(sample.valid == (sample.run > 0));
  require(std::isnan(sample.rate_gyro_dps) == (sample.gyro_count == 0));
  if (std::isnan(sample.rate_shaft_dps)) return require(!sample.valid);
  require(sample.rate_shaft_min_dps <= sample.rate_shaft_dps + 0.01F);
  require(sample.rate_shaft_max_dps >= sample.rate_shaft_dps - 0.01F);
  require(sample.rate_shaft_uncertainty_dps > 0.0F);
}

void check(const wire::Counters& counters) {
  require(counters.bytes_received == counters.bytes_in_messages + counters.bytes_in_damaged +
                                         counters.bytes_skipped + counters.bytes_pending);
}

/// One pass over all chunks; every sample must hold together.
pipeline::Streams decode(const std::vector<Chunk>& chunks, const pipeline::Fits& fits) {
  pipeline::Pipeline pipeline{RigProfile{}, fits};
  std::uint32_t samples = 0;
  std::size_t gyro = 0, servo = 0;
  const auto take = [&](const std::vector<Measurement>& taken) {
    for (const Measurement& measurement : taken) {
      check(measurement.sample, samples++);
      gyro += measurement.gyro.size();
      servo += measurement.servo.size();
    }
  };
  for (const Chunk& chunk : chunks) take(pipeline.feed(chunk.device, chunk.bytes, chunk.arrived));
  take(pipeline.finish());
  pipeline::Streams streams = pipeline.take_streams();
  require(samples == streams.frames.size());
  require(gyro <= streams.gyro.size() && servo <= streams.servo.size());
  for (const Device device : all_devices) check(pipeline.counters(device));
  return streams;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Script script(data, size);
  HostTime now{};
  RawRecording raw;
  std::vector<Chunk> chunks;
  while (!script.done()) {
    chunks.push_back(next_chunk(script, now));
    raw.received[chunks.back().device].append(chunks.back().bytes, now);
  }
  decode(chunks, fit::fit_recording(raw, decode(chunks, {})));
  return 0;
}
