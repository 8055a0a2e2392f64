// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "entries.h"
#include "network_estimators.h"
#include "observer.h"
#include "thermorig/core/error.h"
#include "thermorig/core/estimate_row.h"
#include "thermorig/core/measurement.h"
#include "thermorig/estimators/table.h"

namespace thermorig::estimators {

namespace {

void require_runnable(const Entry& entry, const std::optional<model::Model>& model) {
  if (const auto lack = lack_of(entry, model))
    throw Error(ExitCode::bad_usage, fmt::format("the estimator \"{}\" needs {}", entry.name, lack->needs),
                "the estimator", lack->advice);
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

}  // namespace

struct Bank::Parts {
  std::vector<const Entry*> entries;
  Setup setup;
  std::vector<std::unique_ptr<Estimator>> estimators;
  std::vector<RateEstimate> estimates;
  Observer observer;
};

Bank::Bank(std::span<const std::string> names, const std::optional<model::Model>& model,
           const RigProfile& profile, NetworkRun run, int frames, std::shared_ptr<const odometer::Map> map)
    : parts_(std::make_unique<Parts>()) {
  const std::vector<std::string> all =
      names.empty() ? names_for(model) : std::vector(names.begin(), names.end());
  require_each_once(all);
  parts_->setup.gyro = profile.gyro;
  parts_->setup.camera = profile.camera;
  parts_->setup.frames = frames;
  parts_->setup.map = std::move(map);
  if (model) {
    parts_->setup.network = std::make_shared<NetworkWindow>(*model, run, profile.camera);
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
  parts.observer.take(measurement);
  for (std::size_t i = 0; i < parts.entries.size(); ++i) {
    const Observation observation = parts.observer.seen_with(parts.entries[i]->inputs);
    parts.estimates[i] = parts.estimators[i]->add(observation).value_or(RateEstimate{});
  }
  return parts.estimates;
}

std::uint64_t Bank::ignored() const {
  return parts_->observer.ignored();
}

const odometer::Odometer* Bank::odometer() const {
  for (const auto& estimator : parts_->estimators)
    if (const odometer::Odometer* one = estimator->odometer()) return one;
  return nullptr;
}

}  // namespace thermorig::estimators
