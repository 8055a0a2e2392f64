// SPDX-License-Identifier: MIT
#include "timing_clocks.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <mutex>
#include <string>
#include <utility>

#include "thermorig/timing/link_timing.h"
#include "thermorig/wire/sent_commands.h"
#include "timing_baselines.h"
#include "timing_rig.h"
#include "timing_truth.h"

#include "servo_link.h"

namespace thermorig::bench {
namespace {

constexpr double causal_after_s = 10.0;
constexpr double rounding_s = 1e-6;

const std::array<std::string, 7> methods{"arrival", "line", "rls", "min_rtt", "hull", "causal", "final"};

/// Errors in seconds by method, and how the bounds of the final times did.
struct Errors {
  std::map<std::string, std::vector<float>> by_method;
  std::vector<float> widths_s;
  std::size_t bounded = 0;
  std::size_t later_than_bound = 0;
  std::size_t earlier_than_bound = 0;

  void add(const Errors& other) {
    for (const auto& [method, errors] : other.by_method) {
      auto& all = by_method[method];
      all.insert(all.end(), errors.begin(), errors.end());
    }
    widths_s.insert(widths_s.end(), other.widths_s.begin(), other.widths_s.end());
    bounded += other.bounded;
    later_than_bound += other.later_than_bound;
    earlier_than_bound += other.earlier_than_bound;
  }
};

using StreamErrors = PerDevice<Errors>;

float seconds(HostDuration duration) {
  return static_cast<float>(to_s(duration));
}

double host_s(HostTime time) {
  return to_s(time - bench_start());
}

void check_bounds(const TimeEstimate& estimate, HostTime truth, Errors& errors) {
  ++errors.bounded;
  errors.widths_s.push_back(estimate.earlier_s + estimate.later_s);
  const double off_s = to_s(truth - estimate.time);
  errors.later_than_bound += off_s > static_cast<double>(estimate.later_s) + rounding_s;
  errors.earlier_than_bound += -off_s > static_cast<double>(estimate.earlier_s) + rounding_s;
}

void add_baselines(std::span<const Arrival> arrivals, std::span<const HostTime> truth, Errors& errors) {
  using Method = std::vector<double> (*)(std::span<const Arrival>);
  const std::array<std::pair<std::string, Method>, 4> baselines{{{"arrival", arrival_times},
                                                                 {"line", least_squares_line},
                                                                 {"rls", recursive_least_squares},
                                                                 {"hull", convex_hull_line}}};
  for (const auto& [name, method] : baselines) {
    const std::vector<double> times = method(arrivals);
    for (std::size_t i = 0; i < times.size(); ++i)
      errors.by_method[name].push_back(static_cast<float>(times[i] - host_s(truth[i])));
  }
}

/// A stream that numbers nothing: camera or gyro.
template <typename Timed>
void judge_stream(Device device, const std::vector<Timed>& decoded, const std::vector<TimeEstimate>& final,
                  const simulation::VirtualRigConfig& config,
                  const std::vector<simulation::SentMessage>& sent, Errors& errors) {
  const PortProfile& link = config.profile.link(device);
  const auto truth = sent_of(decoded, sent);
  std::vector<Arrival> arrivals;
  std::vector<HostTime> instants;
  for (std::size_t i = 0; i < decoded.size(); ++i) {
    if (truth[i] == nullptr) continue;
    const HostTime instant = instant_of(*truth[i], device);
    const Stamp& stamp = decoded[i].stamp;
    const double wire_s = timing::wire_time_s(decoded[i].span.size(), link.baud);
    arrivals.push_back(
        {static_cast<double>(truth[i]->index), host_s(stamp.arrival) - wire_s - link.latency_s});
    instants.push_back(instant);
    if (host_s(instant) > causal_after_s) errors.by_method["causal"].push_back(seconds(stamp.time - instant));
    if (final.size() != decoded.size()) continue;
    errors.by_method["final"].push_back(seconds(final[i].time - instant));
    check_bounds(final[i], instant, errors);
  }
  add_baselines(arrivals, instants, errors);
}

/// Pings and their answers, for the baseline that knows nothing else.
std::vector<RoundTrip> round_trips(const Recorded& recorded) {
  std::map<std::uint32_t, HostTime> pinged;
  const RawStream& sent = recorded.raw.sent;
  for (std::size_t i = 0; i < sent.chunk_count(); ++i)
    for (const wire::SentFrame& frame : wire::read_sent(sent.chunk(i)))
      if (frame.type == SERVO_PING) pinged[servo_get_u32(frame.payload.data())] = sent.time(i);
  std::vector<RoundTrip> trips;
  for (const TimedPong& pong : recorded.live.pongs)
    if (const auto ping = pinged.find(pong.token); ping != pinged.end())
      trips.push_back(
          {host_s(ping->second), 1e-6 * pong.receive_us, 1e-6 * pong.send_us, host_s(pong.arrival)});
  return trips;
}

void judge_servo(const Recorded& recorded, const std::vector<TimeEstimate>& final, double wire_s,
                 Errors& errors) {
  std::vector<Arrival> arrivals;
  std::vector<HostTime> instants;
  std::vector<double> mcu_s;
  const auto& servo = recorded.live.servo;
  for (std::size_t i = 0; i < servo.size(); ++i) {
    const HostTime instant =
        recorded.rig->when_servo_clock_read(ServoTime(std::chrono::microseconds(servo[i].mcu_time_us)));
    mcu_s.push_back(1e-6 * static_cast<double>(servo[i].mcu_time_us));
    arrivals.push_back({mcu_s.back(), host_s(servo[i].stamp.arrival) - wire_s});
    instants.push_back(instant);
    if (host_s(instant) > causal_after_s)
      errors.by_method["causal"].push_back(seconds(servo[i].stamp.time - instant));
    if (final.size() != servo.size()) continue;
    errors.by_method["final"].push_back(seconds(final[i].time - instant));
    check_bounds(final[i], instant, errors);
  }
  add_baselines(arrivals, instants, errors);
  const std::vector<double> by_trips = fastest_round_trips(mcu_s, round_trips(recorded));
  for (std::size_t i = 0; i < by_trips.size(); ++i)
    if (host_s(instants[i]) > causal_after_s)
      errors.by_method["min_rtt"].push_back(static_cast<float>(by_trips[i] - host_s(instants[i])));
}

StreamErrors judge(const simulation::VirtualRigConfig& config, double duration_s) {
  const Recorded recorded = record(config, {}, duration_s);
  const pipeline::Fits fits = pipeline::fit(recorded.raw, recorded.live);
  StreamErrors errors;
  judge_stream(Device::camera, recorded.live.frames, fits.times[Device::camera], config,
               recorded.rig->sent_frames(), errors[Device::camera]);
  judge_stream(Device::gyro, recorded.live.gyro, fits.times[Device::gyro], config, recorded.rig->sent_gyro(),
               errors[Device::gyro]);
  const double telemetry_wire_s =
      timing::wire_time_s(recorded.live.servo.empty() ? 0 : recorded.live.servo.front().span.size(),
                          config.profile.servo.link.baud);
  judge_servo(recorded, fits.times[Device::servo], telemetry_wire_s, errors[Device::servo]);
  return errors;
}

/// What each must meet. Camera over FTDI at 1 ms has its own figure: so short a timer gives many chunks a
/// frame, each with its own chance to stall.
std::optional<double> p99_limit_ms(const std::string& method, Device device, const std::string& link) {
  if (device == Device::servo) return std::nullopt;
  if (method == "causal") return 1.5;
  if (method != "final") return std::nullopt;
  if (device == Device::gyro) return 1.2;
  return link == "ftdi1" ? 1.0 : 0.6;
}

void add_error_figures(const std::string& section, const std::string& place, Device device,
                       const std::string& link, Errors& errors, std::vector<Figure>& figures) {
  for (const std::string& method : methods) {
    auto& values = errors.by_method[method];
    if (values.empty() && method != "final") continue;
    const std::string key = fmt::format("{}_{}", place, method);
    const bool limited = method == "final" && device != Device::servo;
    const std::optional<double> rms_ms = values.empty() ? std::nullopt : std::optional(1e3 * rms(values));
    const std::optional<double> p99_ms =
        values.empty() ? std::nullopt : std::optional(1e3 * size_percentile(values, 0.99));
    figures.push_back({.section = section,
                       .key = key + "_rms_ms",
                       .text = method + " RMS",
                       .unit = "ms",
                       .value = rms_ms,
                       .at_most = limited ? std::optional(0.5) : std::nullopt});
    figures.push_back({.section = section,
                       .key = key + "_p99_ms",
                       .text = method + " p99",
                       .unit = "ms",
                       .value = p99_ms,
                       .at_most = p99_limit_ms(method, device, link)});
  }
}

void add_bound_figures(const std::string& section, const std::string& place, Errors& errors,
                       std::vector<Figure>& figures) {
  if (errors.bounded == 0) return;
  const auto share = [&](std::size_t broken) {
    return 100.0 * (1.0 - static_cast<double>(broken) / static_cast<double>(errors.bounded));
  };
  const std::string note = fmt::format("{} samples", errors.bounded);
  figures.push_back({.section = section,
                     .key = place + "_upper_bound_holds_percent",
                     .text = "not after its upper bound",
                     .unit = "%",
                     .value = share(errors.later_than_bound),
                     .at_least = 100.0,
                     .note = note});
  figures.push_back({.section = section,
                     .key = place + "_lower_bound_holds_percent",
                     .text = "not before its lower bound",
                     .unit = "%",
                     .value = share(errors.earlier_than_bound),
                     .at_least = 100.0,
                     .note = note});
  figures.push_back({.section = section,
                     .key = place + "_bound_median_ms",
                     .text = "width of the bounds, median",
                     .unit = "ms",
                     .value = 1e3 * size_percentile(errors.widths_s, 0.5)});
  figures.push_back({.section = section,
                     .key = place + "_bound_max_ms",
                     .text = "width of the bounds, widest",
                     .unit = "ms",
                     .value = 1e3 * size_percentile(errors.widths_s, 1.0)});
}

StreamErrors pooled(std::size_t link, bool loaded, const TableSize& size) {
  StreamErrors all;
  std::mutex adding;
  for_each_seed(size.seeds, [&](std::size_t index) {
    const StreamErrors errors = judge(rig_on(table_links(loaded)[link], index + 1), size.seconds);
    const std::lock_guard lock(adding);
    for (const Device device : all_devices) all[device].add(errors[device]);
  });
  return all;
}

}  // namespace

void add_sample_times(const TableSize& size, std::vector<Figure>& figures) {
  for (const bool loaded : {false, true})
    for (std::size_t link = 0; link < table_links(loaded).size(); ++link) {
      const std::string name = table_links(loaded)[link].name;
      const std::string load = loaded ? "loaded" : "idle";
      StreamErrors errors = pooled(link, loaded, size);
      for (const Device device : {Device::gyro, Device::camera, Device::servo}) {
        const std::string place = fmt::format("{}_{}_{}", name_of(device), name, load);
        const std::string section = fmt::format("{} over {}, host {}", name_of(device), name, load);
        add_error_figures(section, place, device, name, errors[device], figures);
        add_bound_figures(section, place, errors[device], figures);
      }
    }
}

void add_long_servo_clock(const TableSize& size, std::vector<Figure>& figures) {
  const std::vector<TableLink> links = table_links(false);
  std::vector<Errors> errors(links.size());
  for_each_seed(links.size(), [&](std::size_t link) {
    simulation::VirtualRigConfig config = rig_on(links[link], 1000 + link);
    config.profile.camera.output_rate_hz = 1.0;  // only the servo counts here
    errors[link] = judge(config, size.long_seconds)[Device::servo];
  });
  for (std::size_t link = 0; link < links.size(); ++link) {
    const bool cdc = links[link].config.kind == simulation::UsbLink::cdc;
    const std::string section =
        fmt::format("servo clock, {:g} s over {}", size.long_seconds, links[link].name);
    const std::string key = "servo_clock_" + links[link].name;
    const bool measured = errors[link].bounded > 0;
    const auto value = [&](double number) { return measured ? std::optional(number) : std::nullopt; };
    const auto limit = [&](double number) { return cdc ? std::optional(number) : std::nullopt; };
    auto& final = errors[link].by_method["final"];
    figures.push_back({.section = section,
                       .key = key + "_p99_ms",
                       .text = "error p99",
                       .unit = "ms",
                       .value = value(1e3 * size_percentile(final, 0.99)),
                       .at_most = limit(0.1)});
    figures.push_back({.section = section,
                       .key = key + "_causal_p99_ms",
                       .text = "error p99, causal",
                       .unit = "ms",
                       .value = 1e3 * size_percentile(errors[link].by_method["causal"], 0.99)});
    figures.push_back({.section = section,
                       .key = key + "_bound_median_ms",
                       .text = "stated bound, median",
                       .unit = "ms",
                       .value = value(1e3 * size_percentile(errors[link].widths_s, 0.5))});
    figures.push_back({.section = section,
                       .key = key + "_bound_max_ms",
                       .text = "stated bound, widest",
                       .unit = "ms",
                       .value = value(1e3 * size_percentile(errors[link].widths_s, 1.0)),
                       .at_most = limit(0.25)});
    figures.push_back(
        {.section = section,
         .key = key + "_violations",
         .text = "bound violated",
         .unit = "",
         .value = value(static_cast<double>(errors[link].later_than_bound + errors[link].earlier_than_bound)),
         .at_most = 0.0,
         .note = fmt::format("{} messages", errors[link].bounded)});
  }
}

void add_outage(const TableSize& size, std::vector<Figure>& figures) {
  struct Outcome {
    std::vector<float> after_s;
    bool fitted = false;
    bool marked = false;
    int smeared = 0;  // frames whose time lies within the outage
  };
  std::vector<Outcome> outcomes(size.seeds);
  for_each_seed(size.seeds, [&](std::size_t index) {
    simulation::VirtualRigConfig config = rig_on(table_links(index % 2 == 1)[index % 4], index + 1);
    const HostTime begin = config.start + std::chrono::seconds(60);
    const HostTime end = begin + std::chrono::seconds(30);
    config.outages = {{.device = Device::camera, .begin = begin, .end = end}};
    const Recorded recorded = record(config, {}, size.seconds);
    const pipeline::Fits fits = pipeline::fit(recorded.raw, recorded.live);
    const auto& times = fits.times[Device::camera];
    Outcome& outcome = outcomes[index];
    outcome.fitted = times.size() == recorded.live.frames.size() && !times.empty();
    if (!outcome.fitted) return;
    const auto truth = sent_of(recorded.live.frames, recorded.rig->sent_frames());
    // A frame is late by its latency, so the last one before the plug was out was exposed earlier than that.
    const HostDuration margin = std::chrono::milliseconds(500);
    for (std::size_t i = 0; i < times.size(); ++i) {
      if (truth[i] == nullptr) continue;
      if (truth[i]->exposure_end > end)
        outcome.after_s.push_back(seconds(times[i].time - truth[i]->exposure_end));
      outcome.smeared += times[i].time > begin + margin && times[i].time < end - margin;
    }
    if (fits.sync)
      for (const ClockGap& gap : fits.sync->clock[Device::camera].gaps)
        outcome.marked |= gap.begin < begin + margin && gap.end > end - margin;
  });
  std::vector<float> after_s;
  double unmarked = 0.0, smeared = 0.0, fitted = 0.0;
  for (const Outcome& outcome : outcomes) {
    after_s.insert(after_s.end(), outcome.after_s.begin(), outcome.after_s.end());
    fitted += outcome.fitted;
    unmarked += !outcome.marked;
    smeared += outcome.smeared;
  }
  const std::string section = "30 s without the camera, all links";
  const auto value = [&](double number) { return fitted > 0.0 ? std::optional(number) : std::nullopt; };
  figures.push_back({.section = section,
                     .key = "outage_after_p99_ms",
                     .text = "error after it, p99",
                     .unit = "ms",
                     .value = value(1e3 * size_percentile(after_s, 0.99)),
                     .at_most = 1.2});
  figures.push_back({.section = section,
                     .key = "outage_after_max_ms",
                     .text = "error after it, largest",
                     .unit = "ms",
                     .value = value(1e3 * size_percentile(after_s, 1.0)),
                     .at_most = 1.2});
  figures.push_back({.section = section,
                     .key = "outage_unmarked",
                     .text = "recordings without the gap marked",
                     .unit = "",
                     .value = value(unmarked),
                     .at_most = 0.0,
                     .note = fmt::format("{} recordings", size.seeds)});
  figures.push_back({.section = section,
                     .key = "outage_smeared_frames",
                     .text = "frames put into the gap",
                     .unit = "",
                     .value = value(smeared),
                     .at_most = 0.0});
}

}  // namespace thermorig::bench
