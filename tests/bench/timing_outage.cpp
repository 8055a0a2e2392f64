// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "thermorig/core/run_all.h"
#include "thermorig/fit/fit.h"
#include "thermorig/pipeline/pipeline.h"
#include "timing_clocks.h"
#include "timing_errors.h"
#include "timing_rig.h"

namespace thermorig::bench {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

struct Outcome {
  bool fitted = false;
  bool marked = false;
  Errors after;     // of the frames after it, by method; bounds of all frames
  int smeared = 0;  // frames whose time lies within it
};

/// A frame is late by its latency: the last one before the plug was out was exposed a little before that.
constexpr auto margin = milliseconds(500);

Outcome lose_camera(const TableLink& link, std::uint64_t seed, double duration_s) {
  simulation::VirtualRigConfig config = rig_on(link, seed);
  const HostTime begin = config.start + seconds(60);
  const HostTime end = begin + seconds(30);
  config.outages = {{.device = Device::camera, .begin = begin, .end = end}};
  const Recorded recorded = record(config, {}, duration_s);
  const pipeline::Fits fits = fit::fit_recording(recorded.raw, recorded.live);
  const auto& times = fits.times[Device::camera];
  Outcome outcome;
  outcome.fitted = !times.empty() && times.size() == recorded.live.frames.size();
  outcome.after = judge_camera(recorded, times, end);
  for (std::size_t i = 0; outcome.fitted && i < times.size(); ++i)
    outcome.smeared += times[i].time > begin + margin && times[i].time < end - margin;
  const auto covers = [&](const ClockGap& gap) {
    return gap.begin < begin + margin && gap.end > end - margin;
  };
  if (fits.sync) {
    const auto& gaps = fits.sync->clock[Device::camera].gaps;
    outcome.marked = std::any_of(gaps.begin(), gaps.end(), covers);
  }
  return outcome;
}

/// The largest error may be that of a recording's last frame, which nothing behind it holds: what must hold
/// there is the bound.
void add_place(const std::string& row, const std::string& key, std::vector<Outcome>& outcomes,
               std::vector<Figure>& figures) {
  Errors after;
  double unmarked = 0.0, smeared = 0.0, fitted = 0.0;
  for (const Outcome& outcome : outcomes) {
    after.add(outcome.after);
    fitted += outcome.fitted;
    unmarked += !outcome.marked;
    smeared += outcome.smeared;
  }
  const auto add = [&](const std::string& column, const std::string& name, std::optional<double> value,
                       std::optional<double> at_most) {
    figures.push_back({.section = "30 s without the camera: errors after it, p99 in ms",
                       .row = row,
                       .column = column,
                       .key = "outage_" + key + "_" + name,
                       .value = fitted > 0.0 ? value : std::nullopt,
                       .at_most = at_most});
  };
  for (const std::string& method : method_names()) {
    auto& values = after.by_method[method];
    if (values.empty()) continue;
    add(method, method + "_p99_ms", 1e3 * size_percentile(values, 0.99),
        method == "final" ? std::optional(1.2) : std::nullopt);
  }
  add("final, largest", "after_max_ms", 1e3 * size_percentile(after.by_method["final"], 1.0), {});
  add("outside its bounds, all frames", "outside_bounds",
      static_cast<double>(after.later_than_bound + after.earlier_than_bound), 0.0);
  add("gap not marked", "unmarked", unmarked, 0.0);
  add("frames put into the gap", "smeared_frames", smeared, 0.0);
}

}  // namespace

void add_outage(const TableSize& size, std::vector<Figure>& figures) {
  const std::size_t seeds = (size.seeds + 4) / 5;  // of each link and load
  const double duration_s = std::max(size.seconds, 150.0);
  for (const bool loaded : {false, true})
    for (const TableLink& link : table_links(loaded)) {
      std::vector<Outcome> outcomes(seeds);
      on_all_cores(seeds, [&](std::size_t index) {
        outcomes[index] = lose_camera(link, size.first_seed + index, duration_s);
      });
      const std::string load = loaded ? "loaded" : "idle";
      add_place(fmt::format("{} recordings over {}, {}", seeds, link.name, load), link.name + "_" + load,
                outcomes, figures);
    }
}

}  // namespace thermorig::bench
