// SPDX-License-Identifier: MIT
#include "causal_run.h"

#include "thermorig/core/bad_pixels.h"
#include "thermorig/estimators/live/live_estimates.h"
#include "thermorig/network/soundness.h"
#include "thermorig/pipeline/pipeline.h"

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

std::vector<CausalMeasurement> measurements_of(const pipeline::VirtualSweep& sweep) {
  pipeline::Pipeline pipeline(sweep.config.profile);
  std::vector<CausalMeasurement> measurements;
  const auto take = [&](std::vector<Measurement> completed, HostTime arrived) {
    for (Measurement& measurement : completed) measurements.push_back({std::move(measurement), arrived});
  };
  std::size_t next = 0;
  for (const Chunk& chunk : sweep.chunks) {
    for (; next < sweep.sent.chunk_count() && sweep.sent.time(next) <= chunk.arrived; ++next)
      pipeline.sent(Device::servo, sweep.sent.chunk(next), sweep.sent.time(next));
    take(pipeline.feed(chunk.device, chunk.bytes, chunk.arrived), chunk.arrived);
  }
  take(pipeline.finish(), end_of(sweep));
  return measurements;
}

estimators::Bank paper_bank(const std::optional<model::Model>& model, network::Precision precision) {
  const std::vector<EstimatorColumn> columns =
      columns_before_format_2({.name = model ? "model" : "", .fusion = model && model->weights.shape.fusion});
  std::vector<std::string> names;
  for (const EstimatorColumn& column : columns) names.push_back(column.name);
  return {names, model, RigProfile(), {.precision = precision}};
}

std::vector<EstimateRow> rows_of(const std::vector<CausalMeasurement>& measurements,
                                 const std::optional<model::Model>& model) {
  LiveEstimates estimator(paper_bank(model));
  std::vector<EstimateRow> rows;
  for (const auto& [measurement, arrived] : measurements) rows.push_back(estimator.add(measurement, arrived));
  return rows;
}

network::Acquisition acquisition_of(const std::vector<CausalMeasurement>& measurements) {
  network::Acquisition acquisition;
  PixelWatch pixels;
  for (const auto& [measurement, arrived] : measurements) {
    ThermalFrame image = measurement.frame.frame;
    pixels.add(measurement.frame);
    mend(image, pixels.bad());
    const auto& temp_c = image.temp_c;
    acquisition.temp_c.insert(acquisition.temp_c.end(), temp_c.begin(), temp_c.end());
    const LabelledSample& sample = measurement.sample;
    acquisition.label_dps.push_back(sample.rate_commanded_dps);
    acquisition.gyro_dps.push_back(sample.rate_gyro_dps);
    acquisition.time.push_back(sample.time);
    acquisition.run.push_back(sample.valid ? sample.run : 0);
  }
  network::clear_unsound_frames(acquisition);
  return acquisition;
}

model::Model model_for(const network::Acquisition& acquisition, const network::Shape& shape) {
  model::Model model;
  model.weights = network::initial_weights(shape, 4);
  model.scaling = network::scaling_of({&acquisition, 1}, 150.0F);
  return model;
}

}  // namespace thermorig::live
