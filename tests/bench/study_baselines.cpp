// SPDX-License-Identifier: MIT
// The study's acquisitions again, for all estimators that need no training: by causal clocks, against the
// commanded speed and against the true shaft. Nothing is trained, and no result of a training is needed.
// Usage: study_baselines [--json] [--quick]
#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <ctime>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "odometer_recording.h"
#include "thermorig/core/estimate.h"
#include "thermorig/core/run_all.h"
#include "thermorig/estimators/live/live_estimates.h"
#include "timing_figures.h"

namespace thermorig::bench {
namespace {

constexpr int window_frames = 3;  // the study's reference
constexpr double settled_s = 30.0;
constexpr double failed_dps = 30.0;

/// The paper's Table I, as table_one.sh records it: seeds by environment.
struct Environment {
  std::string name;
  std::uint64_t first_seed, last_seed;
};
const std::array<Environment, 4> environments{
    {{"garden", 13, 18}, {"laboratory", 1, 4}, {"dining", 5, 8}, {"kitchen", 9, 12}}};

struct Gyro {
  std::string name;
  simulation::GyroGrade grade;
};
const std::array<Gyro, 2> gyros{{{"raw gyro", simulation::GyroGrade::mpu6050_raw},
                                 {"calibrated gyro", simulation::GyroGrade::calibrated}}};

struct Acquisition {
  OdometerCase recorded;
  std::size_t gyro = 0;
};

/// How one estimator did on one acquisition. NaN: it says nothing of that.
struct Scores {
  double commanded_mse = unknown, shaft_rmse_dps = unknown, failures = unknown;
  double within_1_sigma = unknown, within_2_sigma = unknown;
  double drift_deg_per_min = unknown, worst_deg = unknown;  // of its own angle, from its first one on
  double settled_drift_deg_per_min = unknown,
         settled_worst_deg = unknown;  // of those that it trusts, from 30 s on
  double trusted = unknown;            // share of the frames that it trusts
  double step_us = unknown;
};

double processor_us() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

/// Deviation of an angle from the shaft's, both zero where it begins.
class AngleJudge {
 public:
  void add(double time_s, double off_deg) {
    if (count_ == 0.0) origin_s_ = time_s, origin_deg_ = off_deg;
    const double t = (time_s - origin_s_) / 60.0, deg = off_deg - origin_deg_;
    worst_deg_ = std::max(worst_deg_, std::abs(deg));
    count_ += 1.0, times_ += t, degs_ += deg, squares_ += t * t, products_ += t * deg;
  }
  double worst_deg() const { return count_ > 1.0 ? worst_deg_ : unknown; }
  /// Slope of the straight line that fits best.
  double drift_deg_per_min() const {
    const double spread = count_ * squares_ - times_ * times_;
    return spread > 0.0 ? std::abs((count_ * products_ - times_ * degs_) / spread) : unknown;
  }

 private:
  double origin_s_ = 0.0, origin_deg_ = 0.0, worst_deg_ = 0.0;
  double count_ = 0.0, times_ = 0.0, degs_ = 0.0, squares_ = 0.0, products_ = 0.0;
};

double share(double part, double all) {
  return all > 0.0 ? part / all : unknown;
}

/// True rate of the shaft over the exposure of each frame.
double true_rate_dps(const OdometerRecording& recording, const TimedFrame& frame) {
  return (shaft_deg(recording, frame.exposure_end) - shaft_deg(recording, frame.exposure_begin)) /
         to_s(frame.exposure_end - frame.exposure_begin);
}

Scores scores_of(const OdometerRecording& recording, const std::string& name) {
  live::LiveEstimates estimates(estimators::Bank(std::vector{name}, std::nullopt, recording.profile,
                                                 network::Precision::fp32, window_frames));
  AngleJudge whole, settled;
  std::vector<double> truths_dps, steps_us;
  double windows = 0.0, commanded = 0.0, shaft = 0.0, failures = 0.0, with_sigma = 0.0, in_1 = 0.0,
         in_2 = 0.0;
  double frames = 0.0, trusted = 0.0;
  const HostTime begin = recording.measurements.front().frame.exposure_end;
  for (const Measurement& measurement : recording.measurements) {
    const double before_us = processor_us();
    const EstimateRow row = estimates.add(measurement, measurement.frame.exposure_end);
    steps_us.push_back(processor_us() - before_us);
    truths_dps.push_back(true_rate_dps(recording, measurement.frame));
    const RateEstimate& estimate = row.estimates.front();
    const double time_s = to_s(measurement.frame.exposure_end - begin);
    const bool is_trusted = estimate.state == EstimateState::good;
    frames += 1.0;
    trusted += is_trusted ? 1.0 : 0.0;
    if (std::isfinite(estimate.angle_deg)) {
      const double off_deg = estimate.angle_deg - shaft_deg(recording, measurement.frame.exposure_end);
      whole.add(time_s, off_deg);
      if (time_s >= settled_s && is_trusted) settled.add(time_s, off_deg);
    }
    if (!row.counted || !std::isfinite(estimate.rate_dps)) continue;
    double truth_dps = 0.0;
    for (int i = 0; i < window_frames; ++i)
      truth_dps += truths_dps[truths_dps.size() - 1 - static_cast<std::size_t>(i)] / window_frames;
    const double error_dps = double{estimate.rate_dps} - truth_dps;
    const double against_command_dps = double{estimate.rate_dps} - double{row.rate_commanded_dps};
    windows += 1.0;
    commanded += against_command_dps * against_command_dps;
    shaft += error_dps * error_dps;
    failures += std::abs(error_dps) > failed_dps ? 1.0 : 0.0;
    if (!std::isfinite(estimate.rate_sigma_dps)) continue;
    with_sigma += 1.0;
    in_1 += std::abs(error_dps) <= double{estimate.rate_sigma_dps} ? 1.0 : 0.0;
    in_2 += std::abs(error_dps) <= 2.0 * double{estimate.rate_sigma_dps} ? 1.0 : 0.0;
  }
  std::sort(steps_us.begin(), steps_us.end());
  return {.commanded_mse = share(commanded, windows) / (200.0 * 200.0),
          .shaft_rmse_dps = std::sqrt(share(shaft, windows)),
          .failures = share(failures, windows),
          .within_1_sigma = share(in_1, with_sigma),
          .within_2_sigma = share(in_2, with_sigma),
          .drift_deg_per_min = whole.drift_deg_per_min(),
          .worst_deg = whole.worst_deg(),
          .settled_drift_deg_per_min = settled.drift_deg_per_min(),
          .settled_worst_deg = settled.worst_deg(),
          .trusted = share(trusted, frames),
          .step_us = steps_us[steps_us.size() / 2]};
}

std::vector<std::string> names() {
  return estimators::names_for(std::nullopt);
}

/// What one estimator holds, beside tables that all of its kind share.
double bytes_of(const std::string& name) {
  const auto make = [&] {
    return estimators::Bank(std::vector{name}, std::nullopt, RigProfile(), network::Precision::fp32,
                            window_frames);
  };
  make();  // tables of the program
  const auto used = [] {
    const auto info = mallinfo2();
    return static_cast<double>(info.uordblks + info.hblkhd);
  };
  const double before = used();
  const estimators::Bank bank = make();
  return used() - before;
}

std::vector<Acquisition> acquisitions(bool quick) {
  std::vector<Acquisition> all;
  for (std::size_t gyro = 0; gyro < gyros.size(); ++gyro)
    for (const Environment& environment : environments)
      for (std::uint64_t seed = environment.first_seed; seed <= environment.last_seed; ++seed) {
        if (quick && seed != environment.first_seed) continue;
        all.push_back({{.seed = seed,
                        .environment = environment.name,
                        .plan = "table-one",
                        .gyro_grade = gyros[gyro].grade},
                       gyro});
      }
  return all;
}

/// Median and largest of what there is.
std::optional<double> median_of(std::vector<double> values) {
  std::erase_if(values, [](double one) { return !std::isfinite(one); });
  if (values.empty()) return std::nullopt;
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

std::optional<double> largest_of(std::vector<double> values) {
  std::erase_if(values, [](double one) { return !std::isfinite(one); });
  if (values.empty()) return std::nullopt;
  return *std::max_element(values.begin(), values.end());
}

std::string key_of(std::string text) {
  for (char& one : text)
    one = std::isalnum(static_cast<unsigned char>(one)) == 0 ? '_' : static_cast<char>(std::tolower(one));
  return text;
}

void add_section(std::vector<Figure>& figures, const std::string& section,
                 const std::vector<std::vector<Scores>>& by_name) {
  for (std::size_t i = 0; i < by_name.size(); ++i) {
    const std::string name = names()[i];
    const auto add = [&](const std::string& column, const std::string& unit, std::optional<double> value) {
      figures.push_back({section, name, column, key_of(section + " " + name + " " + column), unit, value,
                         std::nullopt, std::nullopt, ""});
    };
    const auto all = [&](double Scores::*score, double factor = 1.0) {
      std::vector<double> values;
      for (const Scores& one : by_name[i]) values.push_back(factor * (one.*score));
      return values;
    };
    add("MSE", "1e-6", median_of(all(&Scores::commanded_mse, 1e6)));
    add("RMSE, shaft", "deg/s", median_of(all(&Scores::shaft_rmse_dps)));
    add("beyond 30 deg/s", "%", median_of(all(&Scores::failures, 100.0)));
    add("within 1 sigma", "", median_of(all(&Scores::within_1_sigma)));
    add("within 2 sigma", "", median_of(all(&Scores::within_2_sigma)));
    add("drift", "deg/min", median_of(all(&Scores::drift_deg_per_min)));
    add("angle", "deg", median_of(all(&Scores::worst_deg)));
    add("worst", "deg", largest_of(all(&Scores::worst_deg)));
    add("drift, 30 s on", "deg/min", median_of(all(&Scores::settled_drift_deg_per_min)));
    add("angle, 30 s on", "deg", median_of(all(&Scores::settled_worst_deg)));
    add("worst, 30 s on", "deg", largest_of(all(&Scores::settled_worst_deg)));
    add("trusted", "%", median_of(all(&Scores::trusted, 100.0)));
    add("time", "us", median_of(all(&Scores::step_us)));
  }
}

}  // namespace
}  // namespace thermorig::bench

int main(int count, char** arguments) {
  using namespace thermorig::bench;
  const auto options = table_options(count, arguments, "study_baselines [--json] [--quick]");
  if (!options) return 2;
  std::vector<Figure> sizes;
  for (const std::string& name : names())
    sizes.push_back({"Memory", name, "an instance", key_of("memory " + name), "kB", bytes_of(name) / 1000.0,
                     std::nullopt, std::nullopt, ""});
  const std::vector<Acquisition> all = acquisitions(options->quick);
  std::vector<std::vector<Scores>> scores(all.size());
  thermorig::on_all_cores(all.size(), [&](std::size_t i) {
    const OdometerRecording recording = record(all[i].recorded);
    for (const std::string& name : names()) scores[i].push_back(scores_of(recording, name));
  });
  std::vector<Figure> figures;
  for (std::size_t gyro = 0; gyro < gyros.size(); ++gyro)
    for (const bool garden_only : {true, false}) {
      std::vector<std::vector<Scores>> by_name(names().size());
      for (std::size_t i = 0; i < all.size(); ++i) {
        if (all[i].gyro != gyro || (garden_only && all[i].recorded.environment != "garden")) continue;
        for (std::size_t k = 0; k < by_name.size(); ++k) by_name[k].push_back(scores[i][k]);
      }
      add_section(figures, gyros[gyro].name + (garden_only ? ", garden" : ", all environments"), by_name);
    }
  figures.insert(figures.end(), sizes.begin(), sizes.end());
  if (options->json) {
    print_json(figures);
    return 0;
  }
  fmt::print(
      "SIMULATED: the acquisitions of the study (seeds 1 to 18, plan table-one, world honest), causal "
      "clocks; medians "
      "over acquisitions.\n");
  print_text(figures);
  return 0;
}
