// SPDX-License-Identifier: MIT
#include "progress_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "interrupts.h"
#include "live/live_lines.h"
#include "print/output.h"
#include "print/terminal_width.h"
#include "thermorig/io/port.h"

namespace thermorig::app {

namespace {

using rig::DeviceHealth;
using rig::RecordingProgress;
using rig::SweepProgress;

std::string device_line(Device device, const DeviceHealth& health) {
  if (!health.age_s) return fmt::format("{:<7} nothing yet", name_of(device));
  return fmt::format("{:<7} {:<16} age {:>7}  lost {}  bad {}", name_of(device),
                     rate_range_text(health.rate_min_hz, health.rate_max_hz), gap_text(*health.age_s),
                     count_text(health.lost), count_text(health.bad));
}

/// A device that went is waited for: for how long yet.
std::string device_line(Device device, const RecordingProgress& progress) {
  const auto& awaited = progress.awaited[device];
  if (!awaited) return device_line(device, progress.health[device]);
  return fmt::format("{:<7} AWAITED: {}; {:.0f} s left", name_of(device), printable(awaited->why),
                     std::ceil(awaited->left_s));
}

nlohmann::json json_of(const std::optional<rig::AwaitedDevice>& awaited) {
  if (!awaited) return {};
  return {{"why", awaited->why}, {"waited_s", awaited->waited_s}, {"left_s", awaited->left_s}};
}

std::string bar(double share) {
  constexpr int width = 20;
  const int full = std::clamp(static_cast<int>(share * width), 0, width);
  return fmt::format("[{:#<{}}{:.<{}}]", "", full, "", width - full);
}

std::string leg_text(const SweepProgress& sweep) {
  const bool among_legs = sweep.phase == rig::SweepPhase::transit || sweep.phase == rig::SweepPhase::leg ||
                          sweep.phase == rig::SweepPhase::recovering;
  if (sweep.leg == 0 || !among_legs) return name_of(sweep.phase);
  std::string text = fmt::format("leg {} of {}", sweep.leg, sweep.leg_count);
  if (sweep.phase == rig::SweepPhase::leg)
    text += fmt::format(", {}, frame {} of {}", speed_text(sweep.rate_dps),
                        std::min(sweep.frames, sweep.frames_per_leg), sweep.frames_per_leg);
  else
    text += ", " + name_of(sweep.phase);
  return sweep.repeated > 0 ? text + fmt::format(", {} repeated", sweep.repeated) : text;
}

/// One sign a speed: '.' for none of its valid frames, 1 to 9 for tenths, '#' for all.
char quota_sign(const rig::SpeedQuota& speed) {
  if (speed.valid >= speed.wanted) return '#';
  const int tenths = 10 * speed.valid / speed.wanted;
  return tenths == 0 ? '.' : static_cast<char>('0' + tenths);
}

/// All speeds of the plan from -v to +v, a gap in the middle: "-200 [##3..  ..5##] +200 deg/s".
std::string quota_bar(const std::vector<rig::SpeedQuota>& speeds) {
  std::string signs;
  for (std::size_t i = 0; i < speeds.size(); ++i) {
    if (i > 0 && speeds[i].rate_dps > 0.0 && speeds[i - 1].rate_dps < 0.0) signs += ' ';
    signs += quota_sign(speeds[i]);
  }
  return fmt::format("{:+g} [{}] {:+g} deg/s", speeds.front().rate_dps, signs, speeds.back().rate_dps);
}

bool has_quota(const SweepProgress& sweep) {
  return std::any_of(sweep.speeds.begin(), sweep.speeds.end(),
                     [](const rig::SpeedQuota& speed) { return speed.wanted > 0; });
}

std::ptrdiff_t speeds_met(const SweepProgress& sweep) {
  return std::count_if(sweep.speeds.begin(), sweep.speeds.end(),
                       [](const rig::SpeedQuota& speed) { return speed.valid >= speed.wanted; });
}

std::string speeds_text(const SweepProgress& sweep) {
  return fmt::format("{} of {} speeds done", speeds_met(sweep), sweep.speeds.size());
}

/// "valid 31 of 50 at +30.0 deg/s, 12 of 50 speeds done"; empty without a quota.
std::string quota_text(const SweepProgress& sweep) {
  if (!has_quota(sweep)) return "";
  const std::string here =
      sweep.valid_quota == 0
          ? ""
          : fmt::format("valid {} of {} at {}, ", sweep.valid, sweep.valid_quota, speed_text(sweep.rate_dps));
  return here + speeds_text(sweep);
}

/// Of a sweep that was stopped nothing is left to wait for: "7 %".
std::string left_text(const SweepProgress& sweep) {
  std::string done = fmt::format("{:.0f} %", std::floor(100 * sweep.done_share));
  if (sweep.phase >= rig::SweepPhase::stopping) return done;
  return fmt::format("{}, {} left", done, duration_text(sweep.eta_s));
}

class TerminalOutput : public ProgressOutput {
 public:
  ~TerminalOutput() override { output_.write(erasing(drawn_), Matter::word); }
  explicit TerminalOutput(OutputWriter& output) : ProgressOutput(0.25), output_(output) {}
  TerminalOutput(const TerminalOutput&) = delete;
  TerminalOutput& operator=(const TerminalOutput&) = delete;

  void note(const std::string& sentence) override {
    if (output_.write(fmt::format("{}{}\n", erasing(drawn_), folded(printable(sentence))), Matter::word))
      drawn_ = 0;
  }

 private:
  void draw(const RecordingProgress& progress) override {
    const std::vector<std::string> lines = status_lines(progress);
    const std::size_t width = terminal_width() - 1;  // a full line would wrap
    std::string text = erasing(drawn_);
    for (const std::string& line : lines) text += line.substr(0, width) + "\n";
    if (output_.write(std::move(text), Matter::frame)) drawn_ = lines.size();
  }

  OutputWriter& output_;
  std::size_t drawn_ = 0;
};

class PlainOutput : public ProgressOutput {
 public:
  explicit PlainOutput(OutputWriter& output) : ProgressOutput(10.0), output_(output) {}

  void note(const std::string& sentence) override {
    output_.write(folded(printable(sentence)) + "\n", Matter::word);
  }

 private:
  OutputWriter& output_;

  void draw(const RecordingProgress& progress) override {
    output_.write(line(progress) + "\n", Matter::state);
  }

  static std::string line(const RecordingProgress& progress) {
    std::string text = fmt::format("{:>8}  {}, {}", duration_text(progress.elapsed_s),
                                   leg_text(progress.sweep), left_text(progress.sweep));
    if (has_quota(progress.sweep)) text += ", " + speeds_text(progress.sweep);
    std::string devices;
    for (Device device : all_devices) {
      const std::string trouble = progress.absent[device] ? "" : trouble_of(device, progress);
      if (!trouble.empty()) devices += (devices.empty() ? "" : "; ") + trouble;
    }
    return folded(text + (devices.empty() ? "" : "\n          " + devices));
  }

  /// Nothing of a device that sends all it should.
  static std::string trouble_of(Device device, const RecordingProgress& progress) {
    if (const auto& awaited = progress.awaited[device])
      return fmt::format("{} AWAITED, {:.0f} s left", name_of(device), std::ceil(awaited->left_s));
    const DeviceHealth& health = progress.health[device];
    if (!health.age_s) return fmt::format("{} nothing yet", name_of(device));
    if (health.lost == 0 && health.bad == 0) return "";
    return fmt::format("{} lost {}, bad {}", name_of(device), count_text(health.lost),
                       count_text(health.bad));
  }
};

nlohmann::json json_of(const DeviceHealth& health) {
  nlohmann::json object{{"messages", health.messages},
                        {"lost", health.lost},
                        {"bad", health.bad},
                        {"skipped_bytes", health.skipped_bytes},
                        {"rate_min_hz", health.rate_min_hz},
                        {"rate_max_hz", health.rate_max_hz}};
  object["age_s"] = health.age_s ? nlohmann::json(*health.age_s) : nlohmann::json();
  return object;
}

nlohmann::json json_of(const RecordingProgress& progress) {
  const SweepProgress& sweep = progress.sweep;
  nlohmann::json object{{"event", "progress"},
                        {"elapsed_s", progress.elapsed_s},
                        {"phase", name_of(sweep.phase)},
                        {"leg", sweep.leg},
                        {"leg_count", sweep.leg_count},
                        {"rate_dps", sweep.rate_dps},
                        {"frames", sweep.frames},
                        {"frames_per_leg", sweep.frames_per_leg},
                        {"valid", sweep.valid},
                        {"valid_quota", sweep.valid_quota},
                        {"speeds_met", speeds_met(sweep)},
                        {"speed_count", sweep.speeds.size()},
                        {"done_share", sweep.done_share},
                        {"eta_s", sweep.eta_s},
                        {"repeated", sweep.repeated}};
  for (Device device : all_devices) {
    nlohmann::json& line = object["devices"][std::string(name_of(device))];
    line = json_of(progress.health[device]);
    line["awaited"] = json_of(progress.awaited[device]);
  }
  return object;
}

class JsonOutput : public ProgressOutput {
 public:
  explicit JsonOutput(OutputWriter& output) : ProgressOutput(1.0, Clock::recording), output_(output) {}

  void note(const std::string& sentence) override {
    output_.write(json_line({{"event", "note"}, {"message", sentence}}), Matter::word);
  }

 private:
  OutputWriter& output_;

  void draw(const RecordingProgress& progress) override {
    output_.write(json_line(json_of(progress)), Matter::state);
  }
};

bool worth_telling(const RecordingEvent& event) {
  return event.kind != EventKind::leg_start && event.kind != EventKind::leg_end;
}

}  // namespace

void ProgressOutput::show(const RecordingProgress& progress) {
  for (const RecordingEvent& event : progress.events)
    if (worth_telling(event)) note(event.message);
  const HostTime now = clock_ == Clock::wall ? io::now() : progress.time;
  if (drawn_ && now - *drawn_ < period_) return;
  drawn_ = now;
  draw(progress);
}

std::vector<std::string> status_lines(const RecordingProgress& progress) {
  std::vector<std::string> lines;
  for (Device device : all_devices)
    if (!progress.absent[device]) lines.push_back(device_line(device, progress));
  lines.push_back(fmt::format("{} {}  {}", bar(progress.sweep.done_share), left_text(progress.sweep),
                              leg_text(progress.sweep)));
  if (!has_quota(progress.sweep)) return lines;
  lines.push_back(fmt::format("{:<7} {}", "valid", quota_bar(progress.sweep.speeds)));
  lines.push_back(fmt::format("{:<7} {}", "", quota_text(progress.sweep)));
  return lines;
}

ProgressStyle progress_style(bool json) {
  if (json) return ProgressStyle::json;
  return escapes_allowed(stdout) ? ProgressStyle::terminal : ProgressStyle::lines;
}

std::unique_ptr<ProgressOutput> make_progress_output(OutputWriter& output, ProgressStyle style) {
  if (style == ProgressStyle::json) return std::make_unique<JsonOutput>(output);
  if (style == ProgressStyle::terminal) return std::make_unique<TerminalOutput>(output);
  return std::make_unique<PlainOutput>(output);
}

OutputOptions progress_output_options(ProgressStyle style, bool fast) {
  OutputOptions options;
  options.waits = fast;
  options.hurried = interrupted;
  if (style == ProgressStyle::json)
    options.of_dropped = dropped_object;
  else if (style == ProgressStyle::lines)
    options.of_dropped = dropped_line;
  return options;
}

}  // namespace thermorig::app
