// SPDX-License-Identifier: MIT
#include "timing_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "output.h"
#include "speed_pairs.h"
#include "timing_remarks.h"

namespace thermorig::app {

namespace {

using session::Session;

constexpr std::size_t gaps_shown = 5;

std::string ms(double us) {
  return fmt::format("{:.2f}", us / 1e3);
}

std::string signed_count(double value) {
  return fmt::format("{}{}", value < 0 ? "-" : "+",
                     count_text(static_cast<std::uint64_t>(std::llround(std::min(std::abs(value), 1e15)))));
}

std::string timing_line(const std::string& name, const std::string& words) {
  return fmt::format("{:<14}{}\n", name, printable(words));
}

std::string clock_table(const SyncReport& sync) {
  Table table(
      {"clock", "method", ">rate /s", ">skew ppm", ">wander ppm", ">late p50", ">p95", ">max ms", ">+- ms"});
  for (const Device device : all_devices) {
    const ClockReport& clock = sync.clock[device];
    if (clock.method.empty()) {
      const std::string skew = clock.skew_ppm == 0.0 ? "-" : signed_count(clock.skew_ppm);
      table.add({std::string(name_of(device)), "none", "-", skew, "-", "-", "-", "-", "-"});
      continue;
    }
    table.add({std::string(name_of(device)), clock.method, fmt::format("{:.3f}", clock.rate_hz),
               signed_count(clock.skew_ppm), fmt::format("{:.1f}", clock.wander_ppm), ms(clock.late_p50_us),
               ms(clock.late_p95_us), ms(clock.late_max_us), ms(clock.uncertainty_us)});
  }
  return table.text();
}

std::uint64_t missing(const ClockReport& clock) {
  std::uint64_t count = 0;
  for (const ClockGap& gap : clock.gaps) count += gap.missing;
  return count;
}

double longest_gap_s(const ClockReport& clock) {
  double longest_s = 0.0;
  for (const ClockGap& gap : clock.gaps) longest_s = std::max(longest_s, to_s(gap.end - gap.begin));
  return longest_s;
}

/// What the lower end of the bounds rests on: where the device answers, a proof for every clock that wanders
/// no more than that, if so little explains all answers; a setting where it does not.
std::string rests_on(const ClockReport& clock) {
  if (clock.method != "one-way" && clock.bound_wander_ppm > 0.0)
    return fmt::format("proof < {:.3g} ppm", clock.bound_wander_ppm);
  if (clock.method != "one-way") return "not proven";
  return fmt::format("delay < {:.2f} ms", 1e3 * clock.largest_constant_delay_s);
}

std::string bound_table(const SyncReport& sync) {
  Table table({"bounds", ">median ms", ">widest ms", "lower end", ">latency ms", ">+- ms"});
  for (const Device device : all_devices) {
    const ClockReport& clock = sync.clock[device];
    if (clock.method.empty()) continue;
    table.add({std::string(name_of(device)), ms(clock.bound_median_us), ms(clock.bound_us), rests_on(clock),
               ms(1e6 * clock.latency_s), ms(1e6 * clock.latency_uncertainty_s)});
  }
  return table.text();
}

/// Where messages are missing or a clock was reset: how often in all. A line where nothing is and none was.
std::string gap_table(const SyncReport& sync) {
  Table table({"gaps", ">count", ">missing", ">longest", ">epochs"});
  bool is_broken = false;
  for (const Device device : all_devices) {
    const ClockReport& clock = sync.clock[device];
    if (clock.method.empty()) continue;
    is_broken |= !clock.gaps.empty() || clock.epochs.size() > 1;
    table.add({std::string(name_of(device)), count_text(clock.gaps.size()), count_text(missing(clock)),
               clock.gaps.empty() ? "-" : gap_text(longest_gap_s(clock)),
               count_text(std::max<std::size_t>(1, clock.epochs.size()))});
  }
  return is_broken ? table.text() : timing_line("gaps", "none, and no clock was reset");
}

double since_start_s(const Session& session, HostTime time) {
  return to_s(time - session.raw.header.time_reference);
}

/// The gaps and epochs one by one, the first few of each device.
std::string breaks_text(const Session& session) {
  std::string text;
  for (const Device device : all_devices) {
    const ClockReport& clock = session.sync.clock[device];
    for (std::size_t i = 0; i < std::min(gaps_shown, clock.gaps.size()); ++i)
      text += timing_line(
          "gap", fmt::format("{} {:.2f} s to {:.2f} s, {} missing", name_of(device),
                             since_start_s(session, clock.gaps[i].begin),
                             since_start_s(session, clock.gaps[i].end), count_text(clock.gaps[i].missing)));
    if (clock.gaps.size() > gaps_shown)
      text += timing_line(
          "", fmt::format("and {} more of the {}", clock.gaps.size() - gaps_shown, name_of(device)));
    for (std::size_t i = 1; i < clock.epochs.size() && i <= gaps_shown; ++i)
      text += timing_line("new epoch",
                          fmt::format("{} at {:.2f} s: {}", name_of(device),
                                      since_start_s(session, clock.epochs[i].begin), clock.epochs[i].reason));
  }
  return text;
}

std::string offset_text(const CameraOffset& offset) {
  if (!offset.offset_s) return fmt::format("not measured: {}", offset.why_not);
  return fmt::format("{:+.2f} +- {:.2f} ms by {} half-frames, {}", 1e3 * offset.offset_s->value,
                     1e3 * offset.offset_s->uncertainty, count_text(offset.halves),
                     offset.applied ? "applied to the camera's times" : "not applied");
}

std::string calibrated_text(bool calibrated, const std::string& utc) {
  if (!calibrated) return "assumed";
  return utc.empty() ? "calibrated" : "calibrated " + utc;
}

std::string bias_text(const GyroErrors& gyro) {
  if (!gyro.bias_dps) return "not known";
  std::string text = fmt::format("{:+.3f} +- {:.3f} deg/s", gyro.bias_dps->value, gyro.bias_dps->uncertainty);
  if (gyro.bias_before_dps) text += fmt::format(", {:+.3f} at the opening rest", *gyro.bias_before_dps);
  if (gyro.bias_after_dps) text += fmt::format(", {:+.3f} at the closing rest", *gyro.bias_after_dps);
  return text;
}

std::string scale_text(const GyroErrors& gyro, const GyroProfile& profile) {
  const std::string text = timing_line(
      "gyro scale",
      fmt::format("{:.4f} +- {:.4f}; {} as {:.4f} +- {:.4f}", gyro.scale.value, gyro.scale.uncertainty,
                  calibrated_text(gyro.scale_calibrated, profile.scale_measured_utc), profile.scale,
                  profile.scale_uncertainty));
  if (gyro.scale_by_turns)
    return text + timing_line("", fmt::format("by whole turns in this session: {:.4f} +- {:.4f}",
                                              gyro.scale_by_turns->value, gyro.scale_by_turns->uncertainty));
  return gyro.scale_why_not.empty() ? text : text + timing_line("", "not checked: " + gyro.scale_why_not);
}

std::string filter_text(const GyroErrors& gyro) {
  if (gyro.filter_source.empty())
    return fmt::format("not known: all times may be late by up to {:.0f} ms, all by the same",
                       2.5e3 * gyro.filter_delay_s.uncertainty);
  const std::string_view by = gyro.filter_source == "noise"    ? "by its noise"
                              : gyro.filter_source == "device" ? "as the device says"
                                                               : "as the profile states";
  return fmt::format("delays by {:.1f} +- {:.1f} ms, {}", 1e3 * gyro.filter_delay_s.value,
                     1e3 * gyro.filter_delay_s.uncertainty, by);
}

/// Nothing where all rows are exposed at once.
std::string rows_text(const CameraOffset& offset) {
  if (!are_rows_apart(offset)) return "";
  return timing_line(
      "rows", fmt::format("read one after the other, each {:.2f} +- {:.2f} ms after the one {} it; "
                          "times are those of the middle rows",
                          1e3 * std::abs(offset.row_delay_s->value), 1e3 * offset.row_delay_s->uncertainty,
                          offset.row_delay_s->value > 0.0 ? "above" : "below"));
}

std::string gyro_text(const Session& session) {
  const GyroErrors& gyro = session.sync.gyro;
  const GyroProfile& profile = session.raw.header.profile.gyro;
  std::string text = timing_line("gyro bias", bias_text(gyro));
  if (!gyro.bias_course.empty())
    text += timing_line("", fmt::format("it moved from {:+.2f} to {:+.2f} on the way",
                                        gyro.bias_course.front().bias_dps, gyro.bias_course.back().bias_dps));
  if (gyro.zeroes_itself)
    text += timing_line("", "this gyro sets itself to zero at rest: its bias is hidden then");
  text += scale_text(gyro, profile);
  text += timing_line("gyro filter", filter_text(gyro));
  return text + timing_line("gyro noise", std::isfinite(gyro.noise_dps)
                                              ? fmt::format("{:.3f} deg/s a sample at rest", gyro.noise_dps)
                                              : "not known: there was no rest");
}

/// What gyro and images show of each commanded deg/s; nothing where no leg could be compared.
std::string witnesses_text(const Witnesses& witnesses) {
  if (!witnesses.gyro_share) return "";
  const auto share = [](const Estimate& estimate) {
    return fmt::format("{:.3f} +- {:.3f}", estimate.value, estimate.uncertainty);
  };
  return timing_line(
      "of the speed",
      fmt::format("the gyro shows {}, the images {}", share(*witnesses.gyro_share),
                  witnesses.images_share ? share(*witnesses.images_share)
                                         : fmt::format("cannot say: {}", witnesses.images_why_not)));
}

std::string servo_text(const Session& session, const session::Quality& quality) {
  const ServoResponse& servo = session.sync.servo;
  const ServoProfile& profile = session.raw.header.profile.servo;
  std::string text =
      timing_line("servo", fmt::format("{}: delay {:.1f} +- {:.1f} ms, loop {:.1f} Hz, damping 0.7",
                                       servo.fitted ? "fitted to the gyro" : "not fitted, as assumed",
                                       1e3 * servo.delay_s, 1e3 * servo.delay_uncertainty_s, servo.loop_hz));
  if (servo.fitted)
    text += timing_line(
        "", fmt::format("measured against the gyro: the error of its latency (+- {:.1f} ms) is in it, too",
                        1e3 * session.sync.clock[Device::gyro].latency_uncertainty_s));
  text += timing_line("servo scale",
                      fmt::format("{:.4f} +- {:.4f}, {}", servo.scale.value, servo.scale.uncertainty,
                                  calibrated_text(servo.scale_calibrated, profile.scale_measured_utc)));
  const ClockReport& clock = session.sync.clock[Device::servo];
  if (clock.method.empty() && clock.skew_ppm != 0.0)
    text += timing_line("servo speeds", fmt::format("{:.5f} of what it states, by the steps it reports",
                                                    1.0 / (1.0 + 1e-6 * clock.skew_ppm)));
  if (std::isfinite(quality.gyro_residual_dps))
    text += timing_line("residual",
                        fmt::format("{:.2f} deg/s RMS, corrected gyro minus servo model, valid frames",
                                    quality.gyro_residual_dps));
  return text;
}

std::string cell(const std::optional<double>& value, const char* form) {
  if (!value) return "-";
  return fmt::format(fmt::runtime(form), *value);
}

std::string residual_table(const ServoResponse& servo) {
  Table table({">deg/s", ">frames +", ">gyro - model", ">spread", ">frames -", ">gyro - model", ">spread"});
  const auto frames = [](const auto* speed) { return speed ? std::to_string(speed->frames) : "-"; };
  const auto value = [](const auto* speed, double ServoResponse::AtSpeed::*member) {
    return speed ? std::optional(speed->*member) : std::nullopt;
  };
  for (const auto& [magnitude, pair] : by_magnitude(servo.speeds))
    table.add({fmt::format("{:.1f}", static_cast<double>(magnitude) / 100), frames(pair.forward),
               cell(value(pair.forward, &ServoResponse::AtSpeed::residual_dps), "{:+.2f}"),
               cell(value(pair.forward, &ServoResponse::AtSpeed::spread_dps), "{:.2f}"),
               frames(pair.backward),
               cell(value(pair.backward, &ServoResponse::AtSpeed::residual_dps), "{:+.2f}"),
               cell(value(pair.backward, &ServoResponse::AtSpeed::spread_dps), "{:.2f}")});
  return table.text();
}

std::string timing_verdict(const session::Quality& quality) {
  std::string text = timing_line("verdict", quality.verdict);
  for (const std::string& reason : quality.verdict_reasons) text += timing_line("", reason);
  return text;
}

std::string remarks_text(const TimingRemarks& remarks) {
  std::string text;
  for (const std::string& sentence : remarks.sentences)
    text += timing_line(text.empty() ? "remarks" : "", sentence);
  for (const std::string& command : remarks.advice) text += timing_line("try", command);
  return text;
}

std::string reprocess_advice(const std::filesystem::path& path) {
  return fmt::format("not in this file, which is of an older version: thermorig reprocess {}",
                     shell_word(path.string()));
}

}  // namespace

std::string timing_text(const std::filesystem::path& path, const Session& session,
                        const session::Quality& quality) {
  if (!has_timing(session))
    return fmt::format("{}\n{}", printable(path.string()), timing_line("timing", reprocess_advice(path)));
  const SyncReport& sync = session.sync;
  const std::string simulated = session.raw.header.simulated ? " (SIMULATED)" : "";
  std::string text = fmt::format("{}{}\n\n{}\n{}\n{}", printable(path.string()), simulated, clock_table(sync),
                                 bound_table(sync), gap_table(sync));
  if (const std::string breaks = breaks_text(session); !breaks.empty()) text += fmt::format("\n{}", breaks);
  text += fmt::format(
      "\n{}{}{}",
      timing_line("camera - gyro", offset_text(sync.camera_offset)) + rows_text(sync.camera_offset),
      gyro_text(session) + witnesses_text(session.sync.witnesses),
      session.raw.header.profile.servo.is_there() ? servo_text(session, quality)
                                                  : timing_line("labels", "from the gyro: no servo"));
  if (std::isfinite(quality.rate_shaft_uncertainty_dps))
    text += timing_line("shaft", fmt::format("+- {:.2f} deg/s in the median valid frame",
                                             quality.rate_shaft_uncertainty_dps));
  if (!sync.servo.speeds.empty()) text += fmt::format("\n{}", residual_table(sync.servo));
  return fmt::format("{}\n{}{}", text, timing_verdict(quality), remarks_text(timing_remarks(session)));
}

std::string timing_line(const std::filesystem::path& path, const Session& session,
                        const session::Quality& quality) {
  if (!has_timing(session)) return fmt::format("timing   {}\n", printable(reprocess_advice(path)));
  std::string text = "timing   ";
  for (const Device device : all_devices) {
    if (!session.raw.header.profile.has(device)) continue;
    const ClockReport& clock = session.sync.clock[device];
    text += clock.method.empty()
                ? fmt::format("{} unknown, ", name_of(device))
                : fmt::format("{} +- {:.2f} ms, ", name_of(device), clock.uncertainty_us / 1e3);
  }
  if (std::isfinite(quality.rate_shaft_uncertainty_dps))
    text += fmt::format("shaft +- {:.2f} deg/s, ", quality.rate_shaft_uncertainty_dps);
  text.resize(text.size() - std::string_view(", ").size());
  return text + "; more with --timing\n";
}

}  // namespace thermorig::app
