// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "network_window.h"
#include "thermorig/core/error.h"
#include "thermorig/core/estimate_row.h"
#include "thermorig/core/measurement.h"
#include "thermorig/estimators/table.h"

namespace thermorig::estimators {

namespace {

void require_runnable(const Entry& entry, const std::optional<model::Model>& model) {
  if (entry.needs_network && !model)
    throw Error(ExitCode::bad_usage, fmt::format("the estimator \"{}\" needs a network", entry.name),
                "the estimator", "--model FILE");
  if (entry.needs_fusion && !model->weights.shape.fusion)
    throw Error(
        ExitCode::bad_usage,
        fmt::format("the estimator \"{}\" needs a network with fusion, and the model has none", entry.name),
        "the estimator", "a model that was trained with fusion, or \"cnn-thermal\"");
}

void require_each_once(const std::vector<std::string>& names) {
  for (auto name = names.begin(); name != names.end(); ++name)
    if (std::find(names.begin(), name, *name) != name)
      throw Error(ExitCode::bad_usage, fmt::format("the estimator \"{}\" is named twice", *name),
                  "the estimators", "name each once");
  if (names.size() > most_estimators)
    throw Error(ExitCode::bad_usage, fmt::format("{} estimators are too many", names.size()),
                "the estimators", fmt::format("{} at most", most_estimators));
}

/// Since when the servo has been told to stand still, by its own telemetry.
class Stillness {
 public:
  void add(std::span<const TimedServo> states) {
    for (const TimedServo& state : states) {
      if (!is_at_rest(state.state))
        since_.reset();
      else if (!since_ || state.lost_before)
        since_ = state.stamp.time;
    }
  }

  std::optional<HostTime> since() const { return since_; }
  void reset() { since_.reset(); }

 private:
  std::optional<HostTime> since_;
};

/// The same frame without what was seen: times and gaps.
void blank_into(const TimedFrame& frame, TimedFrame& blank) {
  blank = frame;
  blank.frame.temp_c.fill(std::numeric_limits<float>::quiet_NaN());
  blank.frame.sensor_temp_c = std::numeric_limits<float>::quiet_NaN();
  blank.fresh_even = blank.fresh_odd = 0;
}

}  // namespace

struct Bank::Parts {
  std::vector<const Entry*> entries;
  Setup setup;
  std::vector<std::unique_ptr<Estimator>> estimators;
  std::vector<RateEstimate> estimates;
  TimedFrame blank;
  Stillness stillness;
  std::uint64_t count = 0;
};

Bank::Bank(std::span<const std::string> names, const std::optional<model::Model>& model,
           const GyroProfile& gyro, network::Precision precision)
    : parts_(std::make_unique<Parts>()) {
  const std::vector<std::string> all =
      names.empty() ? names_for(model) : std::vector(names.begin(), names.end());
  require_each_once(all);
  parts_->setup.gyro = gyro;
  if (model) {
    parts_->setup.network = std::make_shared<NetworkWindow>(*model, precision);
    parts_->setup.frames = model->weights.shape.frames;
  }
  for (const std::string& name : all) {
    const Entry& known = entry(name);
    require_runnable(known, model);
    parts_->entries.push_back(&known);
    parts_->estimators.push_back(known.make(parts_->setup));
  }
  parts_->estimates.resize(all.size());
}

Bank::~Bank() = default;
Bank::Bank(Bank&&) noexcept = default;
Bank& Bank::operator=(Bank&&) noexcept = default;

std::span<const Entry* const> Bank::entries() const {
  return parts_->entries;
}

int Bank::frames() const {
  return parts_->setup.frames;
}

std::span<const RateEstimate> Bank::add(const Measurement& measurement) {
  Parts& parts = *parts_;
  parts.stillness.add(measurement.servo);
  blank_into(measurement.frame, parts.blank);
  const std::uint64_t index = parts.count++;
  for (std::size_t i = 0; i < parts.entries.size(); ++i) {
    const Inputs& sees = parts.entries[i]->inputs;
    const Observation observation{
        .index = index,
        .frame = sees.image ? measurement.frame : parts.blank,
        .gyro_mean_dps = sees.gyro ? measurement.sample.rate_gyro_dps : RateEstimate::not_known,
        .gyro = sees.gyro ? std::span<const TimedGyro>(measurement.gyro) : std::span<const TimedGyro>(),
        .still_since = sees.rest ? parts.stillness.since() : std::nullopt};
    parts.estimates[i] = parts.estimators[i]->add(observation).value_or(RateEstimate{});
  }
  return parts.estimates;
}

void Bank::reset() {
  parts_->stillness.reset();
  parts_->count = 0;
  for (const auto& estimator : parts_->estimators) estimator->reset();
}

}  // namespace thermorig::estimators
