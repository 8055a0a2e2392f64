// SPDX-License-Identifier: MIT
#include "timing_labels.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>

#include "simulation/random.h"
#include "thermorig/core/error.h"
#include "thermorig/core/run_all.h"
#include "thermorig/fit/fit.h"
#include "thermorig/rig/calibration/calibration.h"
#include "thermorig/rig/recording/finalise.h"
#include "timing_rig.h"
#include "timing_truth.h"

namespace thermorig::bench {
namespace {

struct ServoCase {
  std::string name;
  double travel_deg;
};
const std::array<ServoCase, 3> servos{{{"servo180", 180.0}, {"servo270", 270.0}, {"winch", 2160.0}}};
constexpr std::array<double, 3> loops_hz{5.0, 8.0, 15.0};
constexpr std::array<double, 8> speeds_dps{20.0, 45.0, 70.0, 95.0, 120.0, 145.0, 170.0, 200.0};

/// `speeds` one after the other, directions in turn, each so long and then a rest of a second.
std::vector<Leg> legs_at(std::span<const double> speeds, double leg_s) {
  std::vector<Leg> legs;
  double at_s = 6.0;  // the opening rest, which shows the gyro's bias
  for (std::size_t i = 0; i < speeds.size(); ++i) {
    legs.push_back({at_s, leg_s, i % 2 == 0 ? speeds[i] : -speeds[i]});
    at_s += leg_s + 1.0;
  }
  return legs;
}

/// What the labels of some recordings are worth.
struct LabelScore {
  std::vector<float> error_dps;                // of valid frames
  std::size_t beyond_three = 0;                // of their own uncertainties
  std::size_t true_to_command = 0;             // frames whose true speed stays close to what was commanded
  std::size_t rejected = 0;                    // of these
  std::map<std::string, std::size_t> reasons;  // first reason of a rejected one
  std::size_t frames = 0;

  void add(const LabelScore& other) {
    error_dps.insert(error_dps.end(), other.error_dps.begin(), other.error_dps.end());
    beyond_three += other.beyond_three;
    true_to_command += other.true_to_command;
    rejected += other.rejected;
    frames += other.frames;
    for (const auto& [reason, count] : other.reasons) reasons[reason] += count;
  }
};

/// The shaft, asked by time.
class ShaftTruth {
 public:
  ShaftTruth(const simulation::VirtualRig& rig) : samples_(rig.shaft()) {}

  /// Does the speed, averaged over 20 ms, stay within max(1 deg/s, 2 %) of `rate_dps` from begin to end?
  bool stays_at(double rate_dps, HostTime begin, HostTime end) const {
    constexpr std::ptrdiff_t half_window = 10;  // samples, one a millisecond
    const double slack_dps = std::max(1.0, 0.02 * std::abs(rate_dps));
    const auto before = [](const simulation::TruthSample& sample, HostTime time) {
      return sample.time < time;
    };
    const auto from = std::lower_bound(samples_.begin(), samples_.end(), begin, before) + half_window;
    const auto to = std::lower_bound(samples_.begin(), samples_.end(), end, before) - half_window;
    for (auto at = from; at < to; ++at) {
      const auto first = at - half_window;
      const auto last = at + half_window;
      const double mean_dps = (last->angle_deg - first->angle_deg) / to_s(last->time - first->time);
      if (std::abs(mean_dps - rate_dps) > slack_dps) return false;
    }
    return true;
  }

 private:
  const std::vector<simulation::TruthSample>& samples_;
};

LabelScore score(const session::Session& session, const simulation::VirtualRig& rig) {
  const auto sent = sent_of(session.frames, rig.sent_frames());
  const ShaftTruth shaft(rig);
  LabelScore result;
  for (const LabelledSample& sample : session.samples) {
    const simulation::SentMessage* truth = sent.at(sample.frame_index);
    if (truth == nullptr || sample.leg == 0) continue;
    ++result.frames;
    if (sample.valid) {
      const double error_dps = static_cast<double>(sample.rate_shaft_dps) - truth->mean_rate_dps;
      result.error_dps.push_back(static_cast<float>(error_dps));
      result.beyond_three +=
          !(std::abs(error_dps) <= 3.0 * static_cast<double>(sample.rate_shaft_uncertainty_dps));
    }
    const double commanded_dps = sample.rate_commanded_dps;
    if (!std::isfinite(commanded_dps) || commanded_dps == 0.0) continue;
    if (!shaft.stays_at(commanded_dps, truth->exposure_begin, truth->exposure_end)) continue;
    ++result.true_to_command;
    if (sample.valid) continue;
    ++result.rejected;
    const std::uint8_t reason = sample.first_reason();
    ++result.reasons[reason == 0 ? "none" : std::string(reason_names.at(reason - 1U))];
  }
  return result;
}

/// Environments, links and loads in turn: eight recordings have seen all links and loads, four all
/// environments.
simulation::VirtualRigConfig varied_rig(std::size_t index, std::uint64_t seed) {
  simulation::VirtualRigConfig config = rig_in_world(seed, environment_of(index));
  const auto links = table_links(index / 4 % 2 == 1);
  for (const Device device : all_devices)
    config.links[device] = links[(index + index / 8) % links.size()].config;
  return config;
}

simulation::VirtualRigConfig label_rig(const ServoCase& servo, double loop_hz, std::size_t index,
                                       std::uint64_t seed) {
  simulation::VirtualRigConfig config = varied_rig(index, seed);
  config.profile.servo.travel_deg = servo.travel_deg;
  config.profile.servo.model = servo.name;
  config.servo_loop_hz = loop_hz;
  return config;
}

constexpr double hand_turn_deg = 420.0;

/// `thermorig calibrate scale` with this very rig: turned by hand, since not every servo turns far enough. By
/// the image, or between marks where no turn closes in it.
struct Calibrated {
  RigProfile profile;
  bool by_image = false;
};
Calibrated calibrated(simulation::VirtualRigConfig config) {
  config.hand_turns = {
      {.begin = config.start + std::chrono::seconds(15), .duration_s = 20.0, .angle_deg = hand_turn_deg}};
  const session::Session session = rig::build_session(record(config, {}, 45.0).raw);
  Calibrated result{config.profile, true};
  const std::string utc = "2026-01-01T00:00:00Z";
  try {
    calibration::apply(calibration::measure_scale(session), utc, result.profile);
  } catch (const Error&) {
    result.by_image = false;
    // The marks need a bias at rest: a gyro that hides it is refused, and the profile stays.
    if (!session.sync.gyro.zeroes_itself)
      calibration::apply(calibration::measure_scale_by_marks(session, hand_turn_deg), utc, result.profile);
  }
  return result;
}

struct CaseScores {
  LabelScore calibrated, uncalibrated;
  bool by_image = false;
};

CaseScores run_case(const ServoCase& servo, double loop_hz, std::size_t index, std::uint64_t seed) {
  const simulation::VirtualRigConfig config = label_rig(servo, loop_hz, index, seed);
  const std::vector<Leg> legs = legs_at(speeds_dps, 12.0);
  Recorded recorded = record(config, legs, legs.back().begin_s + legs.back().duration_s + 6.0);
  CaseScores scores;
  scores.uncalibrated = score(rig::build_session(recorded.raw), *recorded.rig);
  const Calibrated rig = calibrated(config);
  scores.by_image = rig.by_image;
  recorded.raw.header.profile = rig.profile;
  scores.calibrated = score(rig::build_session(recorded.raw), *recorded.rig);
  return scores;
}

std::string reasons_text(const LabelScore& score) {
  std::string text;
  for (const auto& [reason, count] : score.reasons)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", reason, count);
  return text;
}

struct LabelLimits {
  std::optional<double> rms_dps, beyond_percent, rejected_percent;
};

// A normal distribution has 0.27 % beyond three of its standard deviations.
constexpr double chance_percent = 0.27;

/// Pooled rows have limits; the few frames of one servo and loop say less than a share of a percent.
void add_label_figures(const std::string& row, const std::string& key, LabelScore& score,
                       const LabelLimits& limits, std::vector<Figure>& figures) {
  const auto valid = static_cast<double>(score.error_dps.size());
  const auto add = [&](const std::string& column, const std::string& figure, const std::string& unit,
                       std::optional<double> value, std::optional<double> at_most, const std::string& note) {
    figures.push_back({.section = "Labels: rate_shaft against the shaft, 20 to 200 deg/s",
                       .row = row,
                       .column = column,
                       .key = fmt::format("labels_{}_{}", key, figure),
                       .unit = unit,
                       .value = value,
                       .at_most = at_most,
                       .note = note});
  };
  const auto of_valid = [&](double value) { return valid > 0.0 ? std::optional(value) : std::nullopt; };
  const auto share = [](std::size_t part, std::size_t whole) {
    return whole > 0 ? std::optional(100.0 * static_cast<double>(part) / static_cast<double>(whole))
                     : std::nullopt;
  };
  add("RMS", "rms_dps", "deg/s", of_valid(rms(score.error_dps)), limits.rms_dps,
      fmt::format("{} valid of {} frames in legs", score.error_dps.size(), score.frames));
  add("largest", "max_dps", "deg/s", of_valid(size_percentile(score.error_dps, 1.0)), {}, "");
  add("beyond 3 sigma", "beyond_three_sigma_percent", "%", share(score.beyond_three, score.error_dps.size()),
      limits.beyond_percent, "");
  add("wrongly rejected", "wrongly_rejected_percent", "%", share(score.rejected, score.true_to_command),
      limits.rejected_percent,
      fmt::format("{} true to the command, rejected for: {}", score.true_to_command, reasons_text(score)));
}

}  // namespace

void add_camera_offset(const TableSize& size, std::vector<Figure>& figures) {
  std::vector<std::optional<double>> errors_s(size.seeds);
  std::vector<std::optional<double>> sigmas(size.seeds);
  on_all_cores(size.seeds, [&](std::size_t index) {
    simulation::VirtualRigConfig config = varied_rig(index, size.first_seed + index);
    simulation::Random boards(size.first_seed + index, "latencies of this table");
    const double camera_more_s = boards.uniform(-0.008, 0.008);
    const double gyro_more_s = boards.uniform(-0.0005, 0.0005);
    config.camera_latency_s = config.profile.camera.link.latency_s + camera_more_s;
    config.gyro_latency_s =
        config.profile.gyro.link.latency_s - 0.5 / config.profile.gyro.output_rate_hz + gyro_more_s;
    std::vector<Leg> legs;
    for (int i = 0; i < 30; ++i)
      legs.push_back({6.0 + 2.0 * i, 1.9, (i % 2 == 0 ? 1.0 : -1.0) * (60.0 + 2.0 * i)});
    const Recorded recorded = record(config, legs, 72.0);
    const pipeline::Fits fits = fit::fit_recording(recorded.raw, recorded.live);
    if (!fits.sync || !fits.sync->camera_offset.offset_s) return;
    const Estimate offset = *fits.sync->camera_offset.offset_s;
    errors_s[index] = offset.value - (camera_more_s - gyro_more_s);
    sigmas[index] = *errors_s[index] / offset.uncertainty;
  });
  std::vector<float> errors, ratios;
  for (std::size_t i = 0; i < size.seeds; ++i) {
    if (!errors_s[i]) continue;
    errors.push_back(static_cast<float>(*errors_s[i]));
    ratios.push_back(static_cast<float>(*sigmas[i]));
  }
  double mean_ms = 0.0;
  for (const float error : errors)
    mean_ms += 1e3 * static_cast<double>(error) / static_cast<double>(errors.size());
  const auto add = [&](const std::string& column, const std::string& key, const std::string& unit,
                       double value, std::optional<double> at_most) {
    figures.push_back({.section = "Camera against gyro, from 60 s of sweeping",
                       .row = fmt::format("found in {} of {} recordings, all environments, links and loads",
                                          errors.size(), size.seeds),
                       .column = column,
                       .key = "camera_offset_" + key,
                       .unit = unit,
                       .value = errors.empty() ? std::nullopt : std::optional(value),
                       .at_most = at_most});
  };
  add("error RMS", "rms_ms", "ms", 1e3 * rms(errors), 1.0);
  add("mean", "mean_ms", "ms", mean_ms, {});
  std::vector<float> about_mean = errors;
  for (float& error : about_mean) error -= static_cast<float>(1e-3 * mean_ms);
  add("RMS about the mean", "rms_about_mean_ms", "ms", 1e3 * rms(about_mean), {});
  add("largest", "max_ms", "ms", 1e3 * size_percentile(errors, 1.0), {});
  add("in its own uncertainties, RMS", "error_in_sigmas", "", rms(ratios), {});
}

void add_labels(const TableSize& size, std::vector<Figure>& figures) {
  struct Case {
    std::size_t servo, loop;
    std::uint64_t seed;
  };
  std::vector<Case> cases;
  const std::size_t repeats =
      (size.seeds + servos.size() * loops_hz.size() - 1) / (servos.size() * loops_hz.size());
  for (std::size_t repeat = 0; repeat < repeats; ++repeat)
    for (std::size_t servo = 0; servo < servos.size(); ++servo)
      for (std::size_t loop = 0; loop < loops_hz.size(); ++loop)
        cases.push_back({servo, loop, size.first_seed + cases.size()});
  std::vector<CaseScores> scores(cases.size());
  on_all_cores(cases.size(), [&](std::size_t i) {
    scores[i] = run_case(servos[cases[i].servo], loops_hz[cases[i].loop], i, cases[i].seed);
  });
  LabelScore all_calibrated, all_uncalibrated;
  std::map<std::string, LabelScore> by_servo;
  double scales = 0.0;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    all_calibrated.add(scores[i].calibrated);
    all_uncalibrated.add(scores[i].uncalibrated);
    by_servo[fmt::format("{}_loop_{:g}_hz", servos[cases[i].servo].name, loops_hz[cases[i].loop])].add(
        scores[i].calibrated);
    scales += scores[i].by_image;
  }
  figures.push_back({.section = "Calibration of the scale, rig turned by hand",
                     .row = fmt::format("{} rigs", cases.size()),
                     .column = "scale found by the image, else between marks",
                     .key = "labels_scale_by_image",
                     .value = scales,
                     .at_least = static_cast<double>(cases.size())});
  add_label_figures("after `calibrate scale`", "calibrated", all_calibrated, {1.0, chance_percent, 5.0},
                    figures);
  add_label_figures("not calibrated", "uncalibrated", all_uncalibrated, {{}, chance_percent, 5.0}, figures);
  for (auto& [name, score] : by_servo) add_label_figures("calibrated, " + name, name, score, {}, figures);
}

}  // namespace thermorig::bench
