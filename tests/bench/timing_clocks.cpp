// SPDX-License-Identifier: MIT
#include "timing_clocks.h"

#include <fmt/format.h>

#include <mutex>
#include <string>

#include "thermorig/core/run_all.h"
#include "timing_errors.h"
#include "timing_rig.h"

namespace thermorig::bench {
namespace {

/// What each must meet, in milliseconds. Camera over FTDI at 1 ms has its own figure: so short a timer gives
/// many chunks a frame, each with its own chance to stall.
std::optional<double> p99_limit_ms(const std::string& method, Device device, const std::string& link) {
  if (device == Device::servo) return std::nullopt;
  if (method == "causal") return 1.5;
  if (method != "final") return std::nullopt;
  if (device == Device::gyro) return 1.2;
  return link == "ftdi1" ? 1.0 : 0.6;
}

std::optional<double> rms_limit_ms(const std::string& method, Device device) {
  return method == "final" && device != Device::servo ? std::optional(0.5) : std::nullopt;
}

/// Where a row stands: one stream over one link.
struct Place {
  Device device;
  std::string link;
  std::string load;
  std::string row() const { return fmt::format("{} over {}, {}", name_of(device), link, load); }
  std::string key() const { return fmt::format("{}_{}_{}", name_of(device), link, load); }
};

std::string left_out(const Errors& errors) {
  return errors.repeats > 0 ? fmt::format("{} repeated frames left out", errors.repeats) : "";
}

void add_error_figures(const Place& place, Errors& errors, std::vector<Figure>& figures) {
  for (const std::string& method : method_names()) {
    auto& values = errors.by_method[method];
    if (values.empty() && method != "final") continue;
    const auto measured = [&](double value_s) {
      return values.empty() ? std::nullopt : std::optional(1e3 * value_s);
    };
    const std::string key = place.key() + "_" + method;
    figures.push_back({.section = "Sample times: error RMS in ms",
                       .row = place.row(),
                       .column = method,
                       .key = key + "_rms_ms",
                       .value = measured(rms(values)),
                       .at_most = rms_limit_ms(method, place.device),
                       .note = method == "final" ? left_out(errors) : ""});
    figures.push_back({.section = "Sample times: error p99 in ms",
                       .row = place.row(),
                       .column = method,
                       .key = key + "_p99_ms",
                       .value = measured(size_percentile(values, 0.99)),
                       .at_most = p99_limit_ms(method, place.device, place.link)});
    figures.push_back({.section = "Sample times, what is constant in a recording removed: error RMS in ms",
                       .row = place.row(),
                       .column = method,
                       .key = key + "_less_constant_rms_ms",
                       .value = measured(rms(errors.by_method[less_constant(method)]))});
  }
}

/// A one-way clock's lower bound rests on a setting, so only the others must hold.
void add_bound_figures(const Place& place, Errors& errors, std::vector<Figure>& figures) {
  if (errors.bounded == 0) return;
  const bool two_way = place.device == Device::servo;
  const auto add = [&](const std::string& column, const std::string& unit, double value,
                       std::optional<double> at_least, const std::string& key) {
    figures.push_back({.section = "Bounds of the final times",
                       .row = place.row(),
                       .column = column,
                       .key = place.key() + "_" + key,
                       .unit = unit,
                       .value = value,
                       .at_least = at_least});
  };
  const auto held = [&](std::size_t broken) {
    return 100.0 - 100.0 * static_cast<double>(broken) / static_cast<double>(errors.bounded);
  };
  add("upper holds", "%", held(errors.later_than_bound), 100.0, "upper_bound_holds_percent");
  add("lower holds", "%", held(errors.earlier_than_bound), two_way ? std::optional(100.0) : std::nullopt,
      "lower_bound_holds_percent");
  add("median width", "ms", 1e3 * size_percentile(errors.widths_s, 0.5), std::nullopt, "bound_median_ms");
  add("widest", "ms", 1e3 * size_percentile(errors.widths_s, 1.0), std::nullopt, "bound_max_ms");
}

PerDevice<Errors> pooled(std::size_t link, bool loaded, const TableSize& size) {
  PerDevice<Errors> all;
  std::mutex adding;
  on_all_cores(size.seeds, [&](std::size_t index) {
    const PerDevice<Errors> errors =
        judge(rig_on(table_links(loaded)[link], size.first_seed + index), size.seconds);
    const std::lock_guard lock(adding);
    for (const Device device : all_devices) all[device].add(errors[device]);
  });
  return all;
}

void add_long_figures(const TableLink& link, double duration_s, Errors& errors,
                      std::vector<Figure>& figures) {
  const bool cdc = link.config.kind == simulation::UsbLink::cdc;
  const auto add = [&](const std::string& column, const std::string& key, const std::string& unit,
                       double value, std::optional<double> at_most) {
    figures.push_back({.section = fmt::format("The servo's clock over {:g} s", duration_s),
                       .row = link.name,
                       .column = column,
                       .key = fmt::format("servo_clock_{}_{}", link.name, key),
                       .unit = unit,
                       .value = errors.bounded > 0 ? std::optional(value) : std::nullopt,
                       .at_most = at_most});
  };
  const auto on_cdc = [&](double limit) { return cdc ? std::optional(limit) : std::nullopt; };
  add("min RTT p99", "min_rtt_p99_ms", "ms", 1e3 * size_percentile(errors.by_method["min_rtt"], 0.99), {});
  add("Klipper p99", "klipper_p99_ms", "ms", 1e3 * size_percentile(errors.by_method["klipper"], 0.99), {});
  add("causal p99", "causal_p99_ms", "ms", 1e3 * size_percentile(errors.by_method["causal"], 0.99), {});
  add("final p99", "p99_ms", "ms", 1e3 * size_percentile(errors.by_method["final"], 0.99), on_cdc(0.1));
  add("bound, median", "bound_median_ms", "ms", 1e3 * size_percentile(errors.widths_s, 0.5), {});
  add("bound, widest", "bound_max_ms", "ms", 1e3 * size_percentile(errors.widths_s, 1.0), on_cdc(0.25));
  add("violated", "violations", "", static_cast<double>(errors.later_than_bound + errors.earlier_than_bound),
      0.0);
}

}  // namespace

void add_sample_times(const TableSize& size, std::vector<Figure>& figures) {
  for (const bool loaded : {false, true})
    for (std::size_t link = 0; link < table_links(loaded).size(); ++link) {
      PerDevice<Errors> errors = pooled(link, loaded, size);
      for (const Device device : {Device::gyro, Device::camera, Device::servo}) {
        const Place place{device, table_links(loaded)[link].name, loaded ? "loaded" : "idle"};
        add_error_figures(place, errors[device], figures);
        add_bound_figures(place, errors[device], figures);
      }
    }
}

void add_long_servo_clock(const TableSize& size, std::vector<Figure>& figures) {
  const std::vector<TableLink> links = table_links(false);
  std::vector<Errors> errors(links.size());
  on_all_cores(links.size(), [&](std::size_t link) {
    simulation::VirtualRigConfig config = rig_on(links[link], size.first_seed + 1000 + link);
    config.profile.camera.output_rate_hz = 1.0;  // only the servo counts here
    errors[link] = judge(config, size.long_seconds)[Device::servo];
  });
  for (std::size_t link = 0; link < links.size(); ++link)
    add_long_figures(links[link], size.long_seconds, errors[link], figures);
}

}  // namespace thermorig::bench
