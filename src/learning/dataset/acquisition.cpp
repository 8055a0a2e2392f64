// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <sha2.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "thermorig/core/bad_pixels.h"
#include "thermorig/core/error.h"
#include "thermorig/core/printable.h"
#include "thermorig/estimators/window_bounds.h"
#include "thermorig/learning/dataset/dataset.h"
#include "thermorig/learning/dataset/run_estimators.h"
#include "thermorig/network/acquisition.h"
#include "thermorig/network/soundness.h"
#include "thermorig/storage/session/annotations.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::dataset {

namespace {

/// Those that need no network and find one rate of so many frames.
std::vector<std::string> names_of(int frames) {
  std::vector<std::string> names;
  for (const estimators::Entry& entry : estimators::all_entries())
    if (!entry.needs_network && entry.most_frames >= frames) names.emplace_back(entry.name);
  return names;
}

float bias_sigma_dps(const estimators::Entry& entry, const RateEstimate& estimate) {
  const auto value = std::ranges::find(entry.values, std::string_view("bias_sigma_dps"));
  return value == entry.values.end()
             ? RateEstimate::not_known
             : estimate.values[static_cast<std::size_t>(value - entry.values.begin())];
}

void add_rates(const session::Session& session, const std::vector<std::string>& names, int frames,
               std::vector<network::RateSeries>& rates) {
  estimators::Bank bank(names, std::nullopt, session.raw.header.profile, {}, frames);
  const std::size_t first = rates.size();
  const std::vector unknown(session.frames.size(), RateEstimate::not_known);
  for (const std::string& name : names) rates.push_back({name, unknown, frames, unknown});
  run_estimators(session, bank, [&](std::size_t frame, std::span<const RateEstimate> estimates) {
    for (std::size_t k = 0; k < estimates.size(); ++k) {
      rates[first + k].rate_dps[frame] = estimates[k].rate_dps;
      rates[first + k].bias_sigma_dps[frame] = bias_sigma_dps(*bank.entries()[k], estimates[k]);
    }
  });
}

/// What the estimators that need no network say of each frame, and of windows of more frames where they find
/// one rate of those. They see what a live run sees, in its order, at the times that the finished session
/// knows.
std::vector<network::RateSeries> rates_without_network(const session::Session& session) {
  std::vector<network::RateSeries> rates;
  int frames = 1;
  for (auto names = names_of(frames); !names.empty(); names = names_of(++frames))
    add_rates(session, names, frames, rates);
  return rates;
}

/// Acquisition::bound_dps of windows of so many frames.
std::vector<float> rate_bounds(const session::Session& session, int frames) {
  estimators::WindowBounds bounds(session.raw.header.profile);
  std::vector<std::size_t> taken;
  run_estimators(session, bounds.bank(), [&](std::size_t frame, std::span<const RateEstimate> estimates) {
    bounds.take(session.frames[frame], estimates);
    taken.push_back(frame);
  });
  std::vector<float> of_frames(session.frames.size(), RateEstimate::not_known);
  const std::vector<float> of_taken = bounds.bounds_dps(frames);
  for (std::size_t i = 0; i < taken.size(); ++i) of_frames[taken[i]] = of_taken[i];
  return of_frames;
}

static_assert(std::endian::native == std::endian::little, "the hash is defined over little-endian values");

class Sha256 {
 public:
  Sha256() { SHA256Init(&state_); }

  template <typename Value>
  void add(std::span<const Value> values) {
    SHA256Update(&state_, reinterpret_cast<const std::uint8_t*>(values.data()), values.size_bytes());
  }

  std::string hexadecimal() {
    std::array<char, SHA256_DIGEST_STRING_LENGTH> text{};
    SHA256End(&state_, text.data());
    return text.data();
  }

 private:
  SHA2_CTX state_{};
};

/// Processors differ in the sign of the NaN that they make.
float with_one_nan(float value) {
  return std::isnan(value) ? std::numeric_limits<float>::quiet_NaN() : value;
}

void add_floats(Sha256& hash, std::span<const float> values) {
  std::array<float, 1024> part{};
  while (!values.empty()) {
    const auto next = values.first(std::min(part.size(), values.size()));
    std::transform(next.begin(), next.end(), part.begin(), with_one_nan);
    hash.add(std::span<const float>(part).first(next.size()));
    values = values.subspan(next.size());
  }
}

/// Nanoseconds, modulo 2^64: times from a file may lie further apart than a duration can tell.
std::vector<std::uint64_t> times_since_first(const std::vector<HostTime>& times) {
  std::vector<std::uint64_t> since;
  since.reserve(times.size());
  for (const HostTime time : times)
    since.push_back(static_cast<std::uint64_t>(to_ns(time)) -
                    static_cast<std::uint64_t>(to_ns(times.front())));
  return since;
}

/// SHA-256, hexadecimal, of what training and evaluation take from an acquisition: number of frames, pixels,
/// labels, gyro means, times since the first frame, runs, commanded speeds of the legs. Little-endian, every
/// NaN the same.
std::string data_hash(const network::Acquisition& acquisition) {
  Sha256 hash;
  const std::array<std::uint64_t, 1> frames{acquisition.frames()};
  hash.add(std::span<const std::uint64_t>(frames));
  add_floats(hash, acquisition.temp_c);
  add_floats(hash, acquisition.label_dps);
  add_floats(hash, acquisition.gyro_dps);
  hash.add(std::span<const std::uint64_t>(times_since_first(acquisition.time)));
  hash.add(std::span<const std::uint32_t>(acquisition.run));
  add_floats(hash, acquisition.leg_rate_dps);
  return hash.hexadecimal();
}

using network::Acquisition;

/// As it was measured; what a file says that cannot be is not believed.
double frame_period_of(const session::Session& session) {
  const double measured_s = session.frame_period_s;
  return measured_s >= 1e-3 && measured_s <= 100.0 ? measured_s
                                                   : 1.0 / session.raw.header.profile.camera.output_rate_hz;
}

network::CameraView view_of(const session::Session& session) {
  const CameraProfile& camera = session.raw.header.profile.camera;
  return {.width_deg = camera.lens_width_deg(),
          .half_frames = session.camera_mode != "full-fresh",
          .mirrored = camera.mirrored};
}

std::map<std::uint16_t, float> leg_rates(const std::vector<LegRecord>& legs) {
  std::map<std::uint16_t, float> rates;
  for (const LegRecord& leg : legs) rates[leg.leg] = static_cast<float>(leg.rate_dps);
  return rates;
}

void append(Acquisition& acquisition, const LabelledSample& sample, const ThermalFrame& frame) {
  acquisition.temp_c.insert(acquisition.temp_c.end(), frame.temp_c.begin(), frame.temp_c.end());
  acquisition.label_dps.push_back(acquisition.is_labelled_by_gyro ? sample.rate_shaft_dps
                                                                  : sample.rate_commanded_dps);
  acquisition.shaft_dps.push_back(sample.rate_shaft_dps);
  acquisition.gyro_dps.push_back(sample.rate_gyro_dps);
  acquisition.time.push_back(sample.time);
  acquisition.run.push_back(sample.valid ? sample.run : 0);
}

void append_samples(Acquisition& acquisition, const session::Session& session) {
  const std::map<std::uint16_t, float> rates = leg_rates(session.raw.legs);
  acquisition.temp_c.reserve(session.samples.size() * frame_pixels);
  assert(session.samples.size() == session.frames.size());
  const PixelPlaces bad = pixel_places(session.sync.bad_pixels);
  for (std::size_t i = 0; i < session.samples.size(); ++i) {
    const LabelledSample& sample = session.samples[i];
    ThermalFrame image = session.frames[i].frame;
    mend(image, bad);
    append(acquisition, sample, image);
    const auto rate = rates.find(sample.leg);
    if (acquisition.is_labelled_by_gyro)
      acquisition.leg_rate_dps.push_back(std::numeric_limits<float>::quiet_NaN());
    else
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
    case Label::measured:
      return sample.rate_measured_dps;
  }
  return std::numeric_limits<float>::quiet_NaN();
}

/// The recording stays known by its commanded speeds, so that a model is recognised whatever it learnt.
void take_label(Acquisition& acquisition, const std::vector<LabelledSample>& samples, Label label) {
  acquisition.label = label;
  if (label == Label::commanded || acquisition.is_labelled_by_gyro) return;
  for (std::size_t i = 0; i < samples.size(); ++i) acquisition.label_dps[i] = rate_of(samples[i], label);
  network::clear_unsound_frames(acquisition);
  acquisition.label_hash = data_hash(acquisition);
}

}  // namespace

Acquisition acquisition_of(const session::Session& session, const std::string& name, Label label) {
  const RecordingHeader& header = session.raw.header;
  const session::Place place = session::place_of(session);
  Acquisition acquisition{.name = name,
                          .environment = place.environment,
                          .number = place.acquisition,
                          .simulated = header.simulated,
                          .frame_period_s = frame_period_of(session),
                          .view = view_of(session),
                          .licence = header.licence.empty() ? "not stated" : header.licence,
                          .is_labelled_by_gyro = !header.profile.servo.is_there()};
  append_samples(acquisition, session);
  network::clear_unsound_frames(acquisition);
  acquisition.hash = data_hash(acquisition);
  take_label(acquisition, session.samples, label);
  return acquisition;
}

void add_estimates(Acquisition& acquisition, const session::Session& session, int bound_frames) {
  acquisition.rates = rates_without_network(session);
  if (bound_frames <= 0) return;
  acquisition.bound_dps = rate_bounds(session, bound_frames);
  acquisition.bound_frames = bound_frames;
}

void require_label(const session::Session& session, Label label, const std::filesystem::path& file) {
  const unsigned needed = label == Label::corrected ? 3 : label == Label::shaft ? 2 : 1;
  if (label == Label::measured && !session.sync.shaft.used) {
    const std::string& why = session.sync.shaft.why_not;
    throw Error(ExitCode::check_failed,
                "the session has no measured speeds: " + (why.empty() ? "nothing measured its shaft" : why),
                file.string(), "--label shaft (measured where it was, else by the servo model)");
  }
  if (session.label_version >= needed) return;
  throw Error(ExitCode::check_failed,
              fmt::format("the session is of a format that had no {}", column_of(label)), file.string(),
              "make it again from its raw bytes: thermorig reprocess " + shell_word(file.string()));
}

std::string name_of(const session::Session& session) {
  const session::Place place = session::place_of(session);
  return fmt::format("{}_acq-{:02}", place.environment, place.acquisition);
}

}  // namespace thermorig::dataset
