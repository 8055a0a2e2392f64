// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <cassert>
#include <limits>
#include <map>

#include "data_hash.h"
#include "rates_without_network.h"
#include "thermorig/core/error.h"
#include "thermorig/learning/dataset/dataset.h"
#include "thermorig/network/soundness.h"
#include "thermorig/storage/session/annotations.h"

namespace thermorig::dataset {

namespace {

using network::Acquisition;

std::map<std::uint16_t, float> leg_rates(const std::vector<LegRecord>& legs) {
  std::map<std::uint16_t, float> rates;
  for (const LegRecord& leg : legs) rates[leg.leg] = static_cast<float>(leg.rate_dps);
  return rates;
}

void append(Acquisition& acquisition, const LabelledSample& sample, const ThermalFrame& frame) {
  acquisition.temp_c.insert(acquisition.temp_c.end(), frame.temp_c.begin(), frame.temp_c.end());
  acquisition.label_dps.push_back(sample.rate_commanded_dps);
  acquisition.shaft_dps.push_back(sample.rate_shaft_dps);
  acquisition.gyro_dps.push_back(sample.rate_gyro_dps);
  acquisition.time.push_back(sample.time);
  acquisition.run.push_back(sample.valid ? sample.run : 0);
}

void append_samples(Acquisition& acquisition, const session::Session& session) {
  const std::map<std::uint16_t, float> rates = leg_rates(session.raw.legs);
  acquisition.temp_c.reserve(session.samples.size() * frame_pixels);
  assert(session.samples.size() == session.frames.size());
  for (std::size_t i = 0; i < session.samples.size(); ++i) {
    const LabelledSample& sample = session.samples[i];
    append(acquisition, sample, session.frames[i].frame);
    const auto rate = rates.find(sample.leg);
    acquisition.leg_rate_dps.push_back(sample.leg == 0 || rate == rates.end() ? 0.0F : rate->second);
  }
}

float rate_of(const LabelledSample& sample, Label label) {
  switch (label) {
    case Label::commanded:
      return sample.rate_commanded_dps;
    case Label::corrected:
      return sample.rate_corrected_dps;
    case Label::shaft:
      return sample.rate_shaft_dps;
  }
  return std::numeric_limits<float>::quiet_NaN();
}

/// The recording stays known by its commanded speeds, so that a model is recognised whatever it learnt.
void take_label(Acquisition& acquisition, const std::vector<LabelledSample>& samples, Label label) {
  if (label == Label::commanded) return;
  acquisition.label = label;
  for (std::size_t i = 0; i < samples.size(); ++i) acquisition.label_dps[i] = rate_of(samples[i], label);
  network::clear_unsound_frames(acquisition);
  acquisition.label_hash = data_hash(acquisition);
}

}  // namespace

Acquisition acquisition_of(const session::Session& session, const std::string& name, Estimates estimates,
                           Label label, int bound_frames) {
  const RecordingHeader& header = session.raw.header;
  const session::Place place = session::place_of(session);
  Acquisition acquisition{.name = name,
                          .environment = place.environment,
                          .number = place.acquisition,
                          .simulated = header.simulated,
                          .licence = header.licence.empty() ? "not stated" : header.licence};
  append_samples(acquisition, session);
  network::clear_unsound_frames(acquisition);
  if (estimates == Estimates::made) acquisition.rates = rates_without_network(session);
  if (bound_frames > 0) {
    acquisition.bound_dps = rate_bounds(session, bound_frames);
    acquisition.bound_frames = bound_frames;
  }
  acquisition.hash = data_hash(acquisition);
  take_label(acquisition, session.samples, label);
  return acquisition;
}

void require_label(const session::Session& session, Label label, const std::filesystem::path& file) {
  const unsigned needed = label == Label::corrected ? 3 : label == Label::shaft ? 2 : 1;
  if (session.label_version >= needed) return;
  throw Error(ExitCode::check_failed,
              fmt::format("the session is of a format that had no {}", column_of(label)), file.string(),
              "make it again from its raw bytes: thermorig reprocess " + file.string());
}

std::string name_of(const session::Session& session) {
  const session::Place place = session::place_of(session);
  return fmt::format("{}_acq-{:02}", place.environment, place.acquisition);
}

}  // namespace thermorig::dataset
