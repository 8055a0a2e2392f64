// SPDX-License-Identifier: MIT
#include "causal_run.h"

#include "thermorig/live/live_estimator.h"
#include "thermorig/pipeline/pipeline.h"
#include "thermorig/windows/soundness.h"

namespace thermorig::live {

namespace {

HostTime end_of(const pipeline::VirtualSweep& sweep) {
  return sweep.chunks.back().arrived + std::chrono::seconds(1);
}

}  // namespace

pipeline::VirtualSweep two_legs() {
  return pipeline::drive(simulation::default_rig(3, "garden"), {{2.0, 6.0, 100.0}, {9.0, 6.0, -150.0}}, 17.0);
}

RawRecording recording_of(const pipeline::VirtualSweep& sweep) {
  RawRecording raw;
  raw.header.profile = sweep.config.profile;
  for (const Chunk& chunk : sweep.chunks) raw.received[chunk.device].append(chunk.bytes, chunk.arrived);
  raw.sent[Device::servo] = sweep.sent;
  raw.complete = true;
  raw.end_time = end_of(sweep);
  return raw;
}

std::vector<CausalPair> pairs_of(const pipeline::VirtualSweep& sweep) {
  pipeline::Pipeline pipeline(sweep.config.profile);
  pipeline::FramePairs waiting;
  std::vector<CausalPair> pairs;
  const auto take = [&](const std::vector<LabelledSample>& samples, HostTime arrived) {
    waiting.add(pipeline.take_streams().frames);
    waiting.add(samples);
    for (pipeline::FramePair& pair : waiting.take()) pairs.push_back({std::move(pair), arrived});
  };
  std::size_t next = 0;
  for (const Chunk& chunk : sweep.chunks) {
    for (; next < sweep.sent.chunk_count() && sweep.sent.time(next) <= chunk.arrived; ++next)
      pipeline.sent(Device::servo, sweep.sent.chunk(next), sweep.sent.time(next));
    take(pipeline.feed(chunk.device, chunk.bytes, chunk.arrived), chunk.arrived);
  }
  take(pipeline.finish(), end_of(sweep));
  return pairs;
}

std::vector<LiveEstimate> rows_of(const std::vector<CausalPair>& pairs,
                                  const std::optional<model::Model>& model) {
  LiveEstimator estimator(model);
  std::vector<LiveEstimate> rows;
  for (const auto& [pair, arrived] : pairs) rows.push_back(estimator.add(pair.frame, pair.sample, arrived));
  return rows;
}

windows::Acquisition acquisition_of(const std::vector<CausalPair>& pairs) {
  windows::Acquisition acquisition;
  for (const auto& [pair, arrived] : pairs) {
    const auto& temp_c = pair.frame.frame.temp_c;
    acquisition.temp_c.insert(acquisition.temp_c.end(), temp_c.begin(), temp_c.end());
    acquisition.label_dps.push_back(pair.sample.rate_commanded_dps);
    acquisition.gyro_dps.push_back(pair.sample.rate_gyro_dps);
    acquisition.time.push_back(pair.sample.time);
    acquisition.run.push_back(pair.sample.valid ? pair.sample.run : 0);
  }
  windows::clear_unsound_frames(acquisition);
  return acquisition;
}

model::Model model_for(const windows::Acquisition& acquisition, const network::Shape& shape) {
  model::Model model;
  model.weights = network::initial_weights(shape, 4);
  model.scaling = windows::scaling_of({&acquisition, 1}, 150.0F);
  return model;
}

}  // namespace thermorig::live
