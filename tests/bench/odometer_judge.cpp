// SPDX-License-Identifier: MIT
#include "odometer_judge.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "thermorig/estimators/table.h"

namespace thermorig::bench {
namespace {

constexpr double settled_s = 30.0;
constexpr double silent_sigmas = 3.0, silent_deg = 3.0;

double processor_us() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

/// One measurement that was tracked.
struct Tracked {
  double time_s = 0.0, angle_deg = 0.0, sigma_deg = 0.0;
  double rate_dps = 0.0, rate_sigma_dps = 0.0;  // its error
  double nis = 0.0;
  bool is_steady = false;
};

double rms(const std::vector<Tracked>& all, bool steady_only) {
  double sum = 0.0, count = 0.0;
  for (const Tracked& one : all) {
    if (steady_only && !one.is_steady) continue;
    sum += one.rate_dps * one.rate_dps;
    count += 1.0;
  }
  return std::sqrt(sum / count);
}

void judge_tracked(const std::vector<Tracked>& all, Judgement& judgement) {
  const auto count = static_cast<double>(all.size());
  double sum = 0.0, times = 0.0;
  for (const Tracked& one : all) {
    sum += one.angle_deg;
    times += one.time_s;
    judgement.worst_deg = std::max(judgement.worst_deg, std::abs(one.angle_deg));
    judgement.mean_nis += one.nis / count;
  }
  judgement.offset_deg = sum / count;
  double squares = 0.0, products = 0.0, time_squares = 0.0, covered = 0.0, rates_covered = 0.0;
  for (const Tracked& one : all) {
    const double angle_deg = one.angle_deg - judgement.offset_deg, time_s = one.time_s - times / count;
    squares += angle_deg * angle_deg;
    products += angle_deg * time_s;
    time_squares += time_s * time_s;
    covered += std::abs(angle_deg) <= 2.0 * one.sigma_deg ? 1.0 : 0.0;
    rates_covered += std::abs(one.rate_dps) <= 2.0 * one.rate_sigma_dps ? 1.0 : 0.0;
  }
  judgement.spread_deg = std::sqrt(squares / count);
  judgement.drift_deg_per_min = 60.0 * products / time_squares;
  judgement.coverage = covered / count;
  judgement.rate_coverage = rates_covered / count;
  judgement.rate_rmse_dps = rms(all, false);
  judgement.steady_rate_rmse_dps = rms(all, true);
}

/// The longest time in which the heading was wrong and nothing said so.
double longest_silence_s(const std::vector<Tracked>& all, double offset_deg) {
  double longest_s = 0.0, since_s = 0.0;
  bool is_wrong = false;
  for (const Tracked& one : all) {
    const double off_deg = std::abs(one.angle_deg - offset_deg);
    const bool was_wrong = is_wrong;
    is_wrong = off_deg > std::max(silent_deg, silent_sigmas * one.sigma_deg);
    if (is_wrong && !was_wrong) since_s = one.time_s;
    if (is_wrong) longest_s = std::max(longest_s, one.time_s - since_s);
  }
  return longest_s;
}

double worst_two_minutes_deg(const std::vector<Tracked>& all) {
  double worst = 0.0;
  for (std::size_t begin = 0, i = 0; i < all.size(); begin = i) {
    double squares = 0.0;
    for (; i < all.size() && all[i].time_s < all[begin].time_s + 120.0; ++i)
      squares += all[i].angle_deg * all[i].angle_deg;
    if (all[begin].time_s >= 120.0)
      worst = std::max(worst, std::sqrt(squares / static_cast<double>(i - begin)));
  }
  return worst;
}

double median_of(std::vector<double> all) {
  std::nth_element(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2), all.end());
  return all[all.size() / 2];
}

/// What the odometer itself says at the end: estimates have no place for all of it.
odometer::Report last_report(const OdometerRecording& recording, const JudgedRun& run) {
  odometer::Odometer odometer(recording.profile.gyro, recording.profile.camera);
  odometer::Report last;
  const HostTime begin = recording.measurements.front().frame.exposure_end + from_s(run.from_s);
  for (const Measurement& one : recording.measurements)
    if (one.frame.exposure_end >= begin) last = odometer.add(one.frame, one.gyro);
  return last;
}

}  // namespace

Judged odometer_of(const OdometerRecording& recording) {
  const auto bank = std::make_shared<estimators::Bank>(std::vector<std::string>{"odometer"}, std::nullopt,
                                                       recording.profile);
  return [bank](const Measurement& one) { return bank->add(one).front(); };
}

Judgement judge(const OdometerRecording& recording, const JudgedRun& run) {
  return judge(recording, run, odometer_of(recording));
}

Judgement judge(const OdometerRecording& recording, const JudgedRun& run, const Judged& judged) {
  Judgement judgement;
  std::vector<Tracked> tracked;
  std::vector<TimedGyro> of_lost;  // frames: their samples come with the next one
  int frames = 0;
  double origin_deg = 0.0, seen = 0.0;
  const HostTime begin = recording.measurements.front().frame.exposure_end + from_s(run.from_s);
  for (const Measurement& recorded : recording.measurements) {
    const TimedFrame& frame = recorded.frame;
    const double time_s = to_s(frame.exposure_end - begin);
    if (time_s < 0.0) continue;
    Measurement measurement = recorded;
    if (run.disturb) run.disturb(time_s, measurement);
    measurement.gyro.insert(measurement.gyro.begin(), of_lost.begin(), of_lost.end());
    of_lost.clear();
    if (run.lost_one_of > 0 && ++frames % run.lost_one_of == 0) {
      of_lost = measurement.gyro;
      continue;
    }
    const RateEstimate estimate = judged(measurement);
    const bool is_tracked = estimate.state == EstimateState::good;
    double off_deg = estimate.angle_deg - shaft_deg(recording, frame.exposure_end);
    if (run.loses_turns && time_s > *run.harm_begin_s)
      off_deg = origin_deg + std::remainder(off_deg - origin_deg, 360.0);
    if (is_tracked && !judgement.tracked_after_s) {
      judgement.tracked_after_s = time_s;
      origin_deg = off_deg;
    }
    const bool is_harmed = run.harm_begin_s && time_s > *run.harm_begin_s && time_s <= *run.harm_end_s;
    if (is_harmed && !is_tracked && !judgement.said_after_s)
      judgement.said_after_s = time_s - *run.harm_begin_s;
    const bool is_after = run.harm_end_s && time_s > *run.harm_end_s;
    if (is_after && is_tracked && !judgement.back_after_s) judgement.back_after_s = time_s - *run.harm_end_s;
    if (is_after && is_tracked && time_s > *run.harm_end_s + 10.0)
      judgement.back_deg = std::max(judgement.back_deg, std::abs(off_deg - origin_deg));
    if (time_s < settled_s) continue;
    seen += 1.0;
    if (!is_tracked) continue;
    const double truth_dps =
        (shaft_deg(recording, frame.exposure_end) - shaft_deg(recording, frame.exposure_begin)) /
        to_s(frame.exposure_end - frame.exposure_begin);
    tracked.push_back({.time_s = time_s,
                       .angle_deg = off_deg - origin_deg,
                       .sigma_deg = double{estimate.angle_sigma_deg},
                       .rate_dps = double{estimate.rate_dps} - truth_dps,
                       .rate_sigma_dps = double{estimate.rate_sigma_dps},
                       .nis = double{estimate.values[3]},
                       .is_steady = measurement.sample.valid});
  }
  judgement.not_tracked = 1.0 - static_cast<double>(tracked.size()) / seen;
  if (!tracked.empty()) judge_tracked(tracked, judgement);
  judgement.silent_s = longest_silence_s(tracked, judgement.offset_deg);
  judgement.worst_two_minutes_deg = worst_two_minutes_deg(tracked);
  if (run.tells_rows) judgement.last = last_report(recording, run);
  return judgement;
}

StepTimes time_steps(const OdometerRecording& recording, double from_s, BeginJudged begin) {
  const HostTime first = recording.measurements.front().frame.exposure_end + thermorig::from_s(from_s);
  std::vector<double> steps_us(recording.measurements.size(), std::numeric_limits<double>::infinity());
  for (int run = 0; run < 2; ++run) {
    const Judged timed = begin(recording);
    for (std::size_t i = 0; i < steps_us.size(); ++i) {
      if (recording.measurements[i].frame.exposure_end < first) continue;
      const double before_us = processor_us();
      timed(recording.measurements[i]);
      steps_us[i] = std::min(steps_us[i], processor_us() - before_us);
    }
  }
  std::erase_if(steps_us, [](double one) { return std::isinf(one); });
  const auto quarter = static_cast<std::ptrdiff_t>(steps_us.size() / 4);
  return {.median_us = median_of(steps_us),
          .worst_us = *std::max_element(steps_us.begin(), steps_us.end()),
          .slower = median_of({steps_us.end() - quarter, steps_us.end()}) /
                    median_of({steps_us.begin() + quarter, steps_us.begin() + 2 * quarter})};
}

}  // namespace thermorig::bench
