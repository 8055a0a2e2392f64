// SPDX-License-Identifier: MIT
#include "rates_without_network.h"

#include "thermorig/estimators/window_bounds.h"
#include "thermorig/learning/dataset/run_estimators.h"

namespace thermorig::dataset {

namespace {

/// Those that need no network and find one rate of so many frames.
std::vector<std::string> names_of(int frames) {
  std::vector<std::string> names;
  for (const estimators::Entry& entry : estimators::all_entries())
    if (!entry.needs_network && entry.most_frames >= frames) names.emplace_back(entry.name);
  return names;
}

void add_rates(const session::Session& session, const std::vector<std::string>& names, int frames,
               std::vector<network::RateSeries>& rates) {
  estimators::Bank bank(names, std::nullopt, session.raw.header.profile, network::Precision::fp32, frames);
  const std::size_t first = rates.size();
  for (const std::string& name : names)
    rates.push_back({name, std::vector(session.frames.size(), RateEstimate::not_known), frames});
  run_estimators(session, bank, [&](std::size_t frame, std::span<const RateEstimate> estimates) {
    for (std::size_t k = 0; k < estimates.size(); ++k)
      rates[first + k].rate_dps[frame] = estimates[k].rate_dps;
  });
}

}  // namespace

std::vector<network::RateSeries> rates_without_network(const session::Session& session) {
  std::vector<network::RateSeries> rates;
  int frames = 1;
  for (auto names = names_of(frames); !names.empty(); names = names_of(++frames))
    add_rates(session, names, frames, rates);
  return rates;
}

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

}  // namespace thermorig::dataset
