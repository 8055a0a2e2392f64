// SPDX-License-Identifier: MIT
#include "rates_without_network.h"

#include <algorithm>
#include <iterator>
#include <span>

#include "thermorig/estimators/table.h"

namespace thermorig::dataset {

namespace {

/// Takes those up to `end` from the front of what is left. A file may say any time: what no recording can
/// hold is left out.
template <typename Sample>
std::vector<Sample> take_until(HostTime end, HostTime reference, std::span<const Sample>& left) {
  const auto later =
      std::find_if(left.begin(), left.end(), [end](const Sample& sample) { return sample.stamp.time > end; });
  std::vector<Sample> taken;
  std::copy_if(left.begin(), later, std::back_inserter(taken),
               [reference](const Sample& sample) { return is_of_recording(sample.stamp.time, reference); });
  left = {later, left.end()};
  return taken;
}

}  // namespace

std::vector<network::RateSeries> rates_without_network(const session::Session& session) {
  const HostTime reference = session.raw.header.time_reference;
  estimators::Bank bank({}, std::nullopt, session.raw.header.profile);
  std::vector<network::RateSeries> rates;
  for (const estimators::Entry* entry : bank.entries())
    rates.push_back({std::string(entry->name), std::vector(session.frames.size(), RateEstimate::not_known)});
  std::span gyro(session.gyro);
  std::span servo(session.servo);
  for (std::size_t i = 0; i < session.frames.size(); ++i) {
    const TimedFrame& frame = session.frames[i];
    if (!is_of_recording(frame.exposure_begin, reference) || !is_of_recording(frame.exposure_end, reference))
      continue;
    const auto estimates = bank.add({.frame = frame,
                                     .sample = session.samples[i],
                                     .gyro = take_until(frame.exposure_end, reference, gyro),
                                     .servo = take_until(frame.exposure_end, reference, servo)});
    for (std::size_t k = 0; k < rates.size(); ++k) rates[k].rate_dps[i] = estimates[k].rate_dps;
  }
  return rates;
}

}  // namespace thermorig::dataset
