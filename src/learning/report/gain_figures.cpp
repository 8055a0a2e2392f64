// SPDX-License-Identifier: MIT
#include "gain_figures.h"

#include <algorithm>

#include "text.h"

namespace thermorig::report {
double peak_of(const study::GainStatistics& gain) {
  const auto fullest = std::max_element(gain.histogram.begin(), gain.histogram.end());
  const auto bin = static_cast<double>(fullest - gain.histogram.begin());
  return (bin + 0.5) / static_cast<double>(study::GainStatistics::bins);
}

std::string gate_text(const study::GainStatistics& gain) {
  if (gain.windows() == 0) return no_value;
  if (!study::collapsed(gain)) return "open";
  return gain.mean < 0.5 ? "collapsed to 0" : "collapsed to 1";
}

}  // namespace thermorig::report
