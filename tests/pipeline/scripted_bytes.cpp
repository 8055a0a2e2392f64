// SPDX-License-Identifier: MIT
#include "scripted_bytes.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "support/at_s.h"
#include "support/telemetry_bytes.h"
#include "thermorig/fit/fit.h"
#include "thermorig/pipeline/timing/link_timing.h"
#include "thermorig/sensors/wire/device_bytes.h"
#include "thermorig/sensors/wire/servo_messages.h"

namespace thermorig::pipeline {

namespace {
double commanded_dps(double t) {
  return std::clamp(std::min(t - 1.0, 4.0 - t) * 2000.0, 0.0, 100.0);
}

double commanded_deg(double t) {
  return 100.0 * std::clamp(t - 1.0, 0.0, 3.0) - 150.0;
}

/// protocols/servo_link.md, "Motion".
float pulse_us(const ServoProfile& servo, double angle_deg) {
  const double us_per_deg = (servo.pulse_max_us - servo.pulse_min_us) / servo.travel_deg;
  const double us = 0.5 * (servo.pulse_min_us + servo.pulse_max_us) + angle_deg * us_per_deg;
  return static_cast<float>(std::round(16.0 * us) / 16.0);
}

void add_telemetry(ScriptedRecording& recording, double duration_s) {
  for (int i = 0; i < static_cast<int>(duration_s * 100); ++i) {
    const double t = 0.002 + 0.01 * i;
    ServoState state;
    state.mcu_us = 0xFFF00000U + static_cast<std::uint32_t>(10'000 * i);  // wraps after 1.05 s
    state.rate_dps = commanded_dps(t);
    state.angle_deg = commanded_deg(t);
    state.pulse_us = pulse_us(recording.profile.servo, commanded_deg(0.02 * std::floor(t / 0.02)));
    state.motion = state.rate_dps > 0.0 ? ServoMotion::steady : ServoMotion::holding;
    state.leg = t > 1.0 && t < 4.0 ? 7 : 0;
    recording.messages.push_back(
        {Device::servo, at_s(t), test::telemetry_bytes(static_cast<std::uint8_t>(i), state)});
  }
}

void add_gyro(ScriptedRecording& recording, double duration_s) {
  for (int i = 0; i < static_cast<int>(duration_s * 200); ++i) {
    const double t = 0.001 + 0.005 * i;
    const auto count = static_cast<std::int16_t>(-commanded_dps(t) / wire::witmotion_dps_per_count);
    const auto packet = wire::witmotion_gyro_packet({5, count, -5}, 30.0F);
    recording.messages.push_back({Device::gyro, at_s(t), {packet.begin(), packet.end()}});
  }
}

void add_frames(ScriptedRecording& recording, double duration_s, bool half_fresh) {
  ThermalFrame frame;
  for (int i = 0; i < static_cast<int>(duration_s * 8) - 1; ++i) {
    for (std::size_t p = 0; p < frame_pixels; ++p)
      if (!half_fresh || subpage_of(p / frame_columns, p % frame_columns) == static_cast<unsigned>(i % 2))
        frame.temp_c[p] = static_cast<float>(20 + (i * 7 + static_cast<int>(p)) % 100) / 4.0F;
    recording.messages.push_back({Device::camera, at_s(0.125 * (i + 1)), wire::camera_frame(frame)});
  }
}

std::vector<Chunk> in_order_of_arrival(std::vector<Chunk> chunks) {
  std::stable_sort(chunks.begin(), chunks.end(),
                   [](const Chunk& a, const Chunk& b) { return a.arrived < b.arrived; });
  return chunks;
}
}  // namespace

ScriptedRecording::ScriptedRecording(double duration_s, bool half_fresh) {
  profile.gyro.axis = 1;
  profile.gyro.sign = -1;
  add_telemetry(*this, duration_s);
  add_gyro(*this, duration_s);
  add_frames(*this, duration_s, half_fresh);
}

std::vector<Chunk> chunks_within_messages(const ScriptedRecording& recording, std::size_t chunk_bytes) {
  std::vector<Chunk> chunks;
  for (const ScriptedMessage& message : recording.messages) {
    const std::uint32_t baud = recording.profile.link(message.device).baud;
    for (std::size_t begin = 0; begin < message.bytes.size(); begin += chunk_bytes) {
      const std::size_t end = std::min(begin + chunk_bytes, message.bytes.size());
      chunks.push_back({message.device,
                        message.begin + from_s(wire_time_s(end, baud)),
                        {message.bytes.begin() + static_cast<std::ptrdiff_t>(begin),
                         message.bytes.begin() + static_cast<std::ptrdiff_t>(end)}});
    }
  }
  return in_order_of_arrival(std::move(chunks));
}

std::vector<Chunk> chunks_across_messages(const ScriptedRecording& recording, unsigned seed,
                                          std::size_t longest) {
  std::mt19937 random(seed);
  std::vector<Chunk> bytes = chunks_within_messages(recording, 1);
  std::vector<Chunk> chunks;
  for (const Device device : all_devices) {
    std::size_t left = 0;
    for (const Chunk& byte : bytes) {
      if (byte.device != device) continue;
      if (left == 0) {
        left = 1 + random() % longest;
        chunks.push_back({device, byte.arrived, {}});
      }
      chunks.back().bytes.push_back(byte.bytes.front());
      chunks.back().arrived = byte.arrived;
      --left;
    }
  }
  return in_order_of_arrival(std::move(chunks));
}

Result run(const RigProfile& profile, const std::vector<Chunk>& chunks, const Fits& fits,
           const RawStream& sent) {
  Pipeline pipeline(profile, fits);
  Result result;
  PerDevice<std::uint64_t> bytes;
  for (const Chunk& chunk : chunks) bytes[chunk.device] += chunk.bytes.size();
  pipeline.expect(bytes);
  const auto take = [&](std::vector<Measurement> measurements) {
    for (Measurement& measurement : measurements) {
      result.samples.push_back(measurement.sample);
      result.measurements.push_back(std::move(measurement));
    }
  };
  std::size_t next = 0;
  for (const Chunk& chunk : chunks) {
    for (; next < sent.chunk_count() && sent.time(next) <= chunk.arrived; ++next)
      pipeline.sent(Device::servo, sent.chunk(next), sent.time(next));
    take(pipeline.feed(chunk.device, chunk.bytes, chunk.arrived));
  }
  take(pipeline.finish());
  result.streams = pipeline.take_streams();
  for (const Device device : all_devices) result.counters[device] = pipeline.counters(device);
  return result;
}

Fits first_pass(const RigProfile& profile, const std::vector<Chunk>& chunks, const RawStream& sent,
                const RunAll& run_all) {
  RawRecording raw;
  raw.header.profile = profile;
  raw.sent[Device::servo] = sent;
  for (const Chunk& chunk : chunks) raw.received[chunk.device].append(chunk.bytes, chunk.arrived);
  return fit::fit_recording(raw, run(profile, chunks, {}, sent).streams, run_all);
}

}  // namespace thermorig::pipeline
