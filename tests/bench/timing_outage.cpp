// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "thermorig/pipeline/pipeline.h"
#include "timing_clocks.h"
#include "timing_rig.h"
#include "timing_truth.h"

namespace thermorig::bench {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

struct Outcome {
  bool fitted = false;
  bool marked = false;
  std::vector<float> after_s;  // errors of the frames after it
  int smeared = 0;             // frames whose time lies within it
};

/// A frame is late by its latency: the last one before the plug was out was exposed a little before that.
constexpr auto margin = milliseconds(500);

Outcome lose_camera(std::size_t index, std::uint64_t seed, double duration_s) {
  const auto links = table_links(index % 2 == 1);
  simulation::VirtualRigConfig config = rig_on(links[index % links.size()], seed);
  const HostTime begin = config.start + seconds(60);
  const HostTime end = begin + seconds(30);
  config.outages = {{.device = Device::camera, .begin = begin, .end = end}};
  const Recorded recorded = record(config, {}, duration_s);
  const pipeline::Fits fits = pipeline::fit(recorded.raw, recorded.live);
  const auto& times = fits.times[Device::camera];
  Outcome outcome;
  outcome.fitted = !times.empty() && times.size() == recorded.live.frames.size();
  const auto truth = sent_of(recorded.live.frames, recorded.rig->sent_frames());
  for (std::size_t i = 0; outcome.fitted && i < times.size(); ++i) {
    if (truth[i] == nullptr) continue;
    if (truth[i]->exposure_end > end)
      outcome.after_s.push_back(static_cast<float>(to_s(times[i].time - truth[i]->exposure_end)));
    outcome.smeared += times[i].time > begin + margin && times[i].time < end - margin;
  }
  const auto covers = [&](const ClockGap& gap) {
    return gap.begin < begin + margin && gap.end > end - margin;
  };
  if (fits.sync) {
    const auto& gaps = fits.sync->clock[Device::camera].gaps;
    outcome.marked = std::any_of(gaps.begin(), gaps.end(), covers);
  }
  return outcome;
}

}  // namespace

void add_outage(const TableSize& size, std::vector<Figure>& figures) {
  std::vector<Outcome> outcomes(size.seeds);
  const double duration_s = std::max(size.seconds, 150.0);
  for_each_seed(size.seeds, [&](std::size_t index) {
    outcomes[index] = lose_camera(index, size.first_seed + index, duration_s);
  });
  std::vector<float> after_s;
  double unmarked = 0.0, smeared = 0.0, fitted = 0.0;
  for (const Outcome& outcome : outcomes) {
    after_s.insert(after_s.end(), outcome.after_s.begin(), outcome.after_s.end());
    fitted += outcome.fitted;
    unmarked += !outcome.marked;
    smeared += outcome.smeared;
  }
  const auto add = [&](const std::string& column, const std::string& key, const std::string& unit,
                       double value, double at_most) {
    figures.push_back({.section = "30 s without the camera",
                       .row = fmt::format("{} recordings, all links and loads", size.seeds),
                       .column = column,
                       .key = "outage_" + key,
                       .unit = unit,
                       .value = fitted > 0.0 ? std::optional(value) : std::nullopt,
                       .at_most = at_most});
  };
  add("error after it, p99", "after_p99_ms", "ms", 1e3 * size_percentile(after_s, 0.99), 1.2);
  add("largest", "after_max_ms", "ms", 1e3 * size_percentile(after_s, 1.0), 1.2);
  add("gap not marked", "unmarked", "", unmarked, 0.0);
  add("frames put into the gap", "smeared_frames", "", smeared, 0.0);
}

}  // namespace thermorig::bench
