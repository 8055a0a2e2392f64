// SPDX-License-Identifier: MIT
#include "rates_without_network.h"

#include "thermorig/learning/dataset/run_estimators.h"

namespace thermorig::dataset {

std::vector<network::RateSeries> rates_without_network(const session::Session& session) {
  estimators::Bank bank({}, std::nullopt, session.raw.header.profile);
  std::vector<network::RateSeries> rates;
  for (const estimators::Entry* entry : bank.entries())
    rates.push_back({std::string(entry->name), std::vector(session.frames.size(), RateEstimate::not_known)});
  run_estimators(session, bank, [&](std::size_t frame, std::span<const RateEstimate> estimates) {
    for (std::size_t k = 0; k < rates.size(); ++k) rates[k].rate_dps[frame] = estimates[k].rate_dps;
  });
  return rates;
}

}  // namespace thermorig::dataset
