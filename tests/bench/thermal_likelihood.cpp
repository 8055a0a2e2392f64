// SPDX-License-Identifier: MIT
// How the images alone tell the rate on simulated rigs in virtual time, against the true shaft and the bound.
// Usage: thermal_likelihood [--json] [--first-seed N] [--quick]
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <string>
#include <string_view>
#include <vector>

#include "odometer_recording.h"
#include "thermorig/core/estimate.h"
#include "thermorig/core/run_all.h"
#include "thermorig/estimators/table.h"
#include "thermorig/estimators/window_bounds.h"
#include "thermorig/network/window_index.h"
#include "timing_figures.h"

namespace thermorig::bench {
namespace {

const std::array<std::string, 4> environments{"laboratory", "dining", "kitchen", "garden"};
constexpr int window_frames = 3;
constexpr double label_scale_dps = 200.0;  // of the normalised MSE, as in the study
constexpr double told_sigma_dps = 20.0, well_known_dps = 2.0, known_dps = 5.0;
constexpr double far_dps = 30.0;
constexpr double silent_sigmas = 4.0;

struct Judged {
  double rate_dps = 0.0, error_dps = 0.0, sigma_dps = 0.0, bound_dps = 0.0;
};

struct Row {
  std::string environment;
  std::uint64_t seed = 0;
  std::vector<Judged> windows;
  double angle_deg = 0.0, angle_sigma_deg = 0.0;  // error of the angle over the whole recording
  std::vector<double> steps_us;
};

double processor_us() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

std::vector<float> bounds_of(const OdometerRecording& recording) {
  estimators::WindowBounds bounds(recording.profile);
  for (const Measurement& measurement : recording.measurements)
    bounds.take(measurement.frame, bounds.bank().add(measurement));
  return bounds.bounds_dps(window_frames);
}

void judge(Row& row) {
  const OdometerRecording recording = record({.seed = row.seed, .environment = row.environment});
  const std::vector<float> bounds = bounds_of(recording);
  estimators::Bank bank(std::vector<std::string>{"thermal-likelihood"}, std::nullopt, recording.profile, {},
                        window_frames);
  network::WindowRule rule(window_frames);
  const auto& measurements = recording.measurements;
  for (std::size_t i = 0; i < measurements.size(); ++i) {
    const double before_us = processor_us();
    const RateEstimate estimate = bank.add(measurements[i]).front();
    row.steps_us.push_back(processor_us() - before_us);
    const LabelledSample& sample = measurements[i].sample;
    const bool is_window = rule.push(sample.valid ? sample.run : 0);
    row.angle_deg = estimate.angle_deg;
    row.angle_sigma_deg = double{estimate.angle_sigma_deg};
    if (!is_window || !std::isfinite(estimate.rate_dps)) continue;
    const HostTime begin = measurements[i + 1 - window_frames].frame.exposure_begin;
    const HostTime end = measurements[i].frame.exposure_end;
    const double truth_dps = (shaft_deg(recording, end) - shaft_deg(recording, begin)) / to_s(end - begin);
    row.windows.push_back({.rate_dps = truth_dps,
                           .error_dps = double{estimate.rate_dps} - truth_dps,
                           .sigma_dps = double{estimate.rate_sigma_dps},
                           .bound_dps = double{bounds[i]}});
  }
  row.angle_deg -= shaft_deg(recording, measurements.back().frame.exposure_end) -
                   shaft_deg(recording, measurements.front().frame.exposure_end);
}

double middle_of(std::vector<double> values) {
  if (values.empty()) return unknown;
  std::sort(values.begin(), values.end());
  const std::size_t count = values.size();
  return 0.5 * (values[(count - 1) / 2] + values[count / 2]);
}

/// Figures over those windows for which `is_one` holds.
template <typename IsOne>
std::vector<Judged> those(const std::vector<Judged>& windows, IsOne is_one) {
  std::vector<Judged> chosen;
  std::copy_if(windows.begin(), windows.end(), std::back_inserter(chosen), is_one);
  return chosen;
}

template <typename Is>
double share(const std::vector<Judged>& windows, Is is) {
  if (windows.empty()) return unknown;
  return static_cast<double>(std::count_if(windows.begin(), windows.end(), is)) /
         static_cast<double>(windows.size());
}

template <typename Value>
double root_mean_square(const std::vector<Judged>& windows, Value value) {
  double sum = 0.0;
  for (const Judged& one : windows) sum += value(one) * value(one);
  return std::sqrt(sum / static_cast<double>(windows.size()));
}

template <typename Value>
double median(const std::vector<Judged>& windows, Value value) {
  std::vector<double> values;
  for (const Judged& one : windows) values.push_back(value(one));
  return middle_of(std::move(values));
}

double error_of(const Judged& one) {
  return one.error_dps;
}
double size_of(const Judged& one) {
  return std::abs(one.error_dps);
}
double bound_of(const Judged& one) {
  return one.bound_dps;
}
/// How much larger rates are told than they are.
double mean_excess(const std::vector<Judged>& windows) {
  double sum = 0.0;
  for (const Judged& one : windows) sum += std::copysign(1.0, one.rate_dps) * one.error_dps;
  return sum / static_cast<double>(windows.size());
}

bool is_told(const Judged& one) {
  return one.sigma_dps < told_sigma_dps;
}
bool is_covered(const Judged& one) {
  return size_of(one) <= 2.0 * one.sigma_dps;
}

std::string key_of(std::string text) {
  for (char& one : text)
    if (std::isalnum(static_cast<unsigned char>(one)) == 0) one = '_';
  return text;
}

class Section {
 public:
  Section(std::vector<Figure>& figures, std::string name) : figures_(figures), name_(std::move(name)) {}
  void add(const std::string& row, const std::string& column, const std::string& unit, double value,
           std::optional<double> at_most = {}, std::optional<double> at_least = {}) {
    const std::optional<double> known = std::isfinite(value) ? std::optional(value) : std::nullopt;
    figures_.push_back(
        {name_, row, column, key_of(name_ + " " + row + " " + column), unit, known, at_most, at_least, ""});
  }

 private:
  std::vector<Figure>& figures_;
  std::string name_;
};

void add_environment(std::vector<Figure>& figures, const std::string& environment,
                     const std::vector<Row>& rows) {
  std::vector<Judged> all;
  std::vector<double> errors;
  for (const Row& row : rows) {
    if (row.environment != environment) continue;
    all.insert(all.end(), row.windows.begin(), row.windows.end());
    const double rmse = root_mean_square(row.windows, error_of) / label_scale_dps;
    errors.push_back(1e6 * rmse * rmse);
  }
  const bool is_garden = environment == "garden";
  const std::optional<double> none;
  const auto told = those(all, is_told);
  const auto well_known = those(all, [](const Judged& one) { return one.bound_dps < well_known_dps; });
  const auto known = those(all, [](const Judged& one) { return one.bound_dps < known_dps; });
  Section errors_of(figures, "Windows of three frames");
  errors_of.add(environment, "windows", "", static_cast<double>(all.size()));
  errors_of.add(environment, "median MSE", "1e-6", middle_of(errors), is_garden ? 50.0 : none);
  errors_of.add(environment, "RMSE", "deg/s", root_mean_square(all, error_of));
  errors_of.add(environment, "RMSE where told", "deg/s", root_mean_square(told, error_of));
  errors_of.add(environment, "median error", "deg/s", median(all, size_of));
  errors_of.add(environment, "beyond 30 deg/s", "%",
                100.0 * share(all, [](const Judged& one) { return size_of(one) > far_dps; }));
  Section sigmas(figures, "Stated sigma");
  sigmas.add(environment, "median", "deg/s", median(all, [](const Judged& one) { return one.sigma_dps; }));
  sigmas.add(environment, "within 2 sigma", "", share(all, is_covered), none,
             is_garden ? none : std::optional(0.9));
  sigmas.add(environment, "where told", "", share(told, is_covered));
  sigmas.add(environment, "told", "%", 100.0 * share(all, is_told));
  sigmas.add(environment, "wrong and silent", "%",
             100.0 * share(all, [](const Judged& one) {
               return is_told(one) && size_of(one) > std::max(told_sigma_dps, silent_sigmas * one.sigma_dps);
             }));
  Section bounds(figures, "Beside the bound");
  bounds.add(environment, "bound, median", "deg/s", median(all, bound_of));
  bounds.add(environment, "told, bound below 5", "%", 100.0 * share(known, is_told), none, 50.0);
  bounds.add(environment, "windows, bound below 2", "", static_cast<double>(well_known.size()));
  bounds.add(environment, "RMSE / bound there", "",
             root_mean_square(well_known, error_of) / root_mean_square(well_known, bound_of), 3.0);
  bounds.add(environment, "of those told", "", [&] {
    const auto both = those(well_known, is_told);
    return root_mean_square(both, error_of) / root_mean_square(both, bound_of);
  }());
  bounds.add(environment, "median error / bound", "",
             median(well_known, [](const Judged& one) { return size_of(one) / one.bound_dps; }) / 0.6745);
}

void add_speeds(std::vector<Figure>& figures, const std::vector<Row>& rows) {
  Section speeds(figures, "Garden by speed");
  std::vector<Judged> all;
  for (const Row& row : rows)
    if (row.environment == "garden") all.insert(all.end(), row.windows.begin(), row.windows.end());
  double low_dps = 0.0;
  for (const double high_dps : {50.0, 100.0, 150.0, 210.0}) {
    const auto part = those(all, [&](const Judged& one) {
      return std::abs(one.rate_dps) >= low_dps && std::abs(one.rate_dps) < high_dps;
    });
    const std::string name = fmt::format("{:.0f} to {:.0f} deg/s", low_dps, high_dps);
    speeds.add(name, "RMSE", "deg/s", root_mean_square(part, error_of));
    speeds.add(name, "too fast by", "deg/s", mean_excess(part));
    speeds.add(name, "sigma, median", "deg/s", median(part, [](const Judged& one) { return one.sigma_dps; }));
    speeds.add(name, "bound, median", "deg/s", median(part, bound_of));
    low_dps = high_dps;
  }
}

void add_angles(std::vector<Figure>& figures, const std::vector<Row>& rows) {
  Section angles(figures, "Angle at the end, and work");
  for (const std::string& environment : environments) {
    std::vector<double> sizes, sigmas, steps_us;
    double covered = 0.0;
    for (const Row& row : rows) {
      if (row.environment != environment) continue;
      sizes.push_back(std::abs(row.angle_deg));
      sigmas.push_back(row.angle_sigma_deg);
      covered += std::abs(row.angle_deg) <= 2.0 * row.angle_sigma_deg ? 1.0 : 0.0;
      steps_us.insert(steps_us.end(), row.steps_us.begin(), row.steps_us.end());
    }
    angles.add(environment, "error, median", "deg", middle_of(sizes));
    angles.add(environment, "sigma, median", "deg", middle_of(sigmas));
    angles.add(environment, "within 2 sigma", "", covered / static_cast<double>(sizes.size()));
    angles.add(environment, "step, median", "us", middle_of(steps_us), 150.0);
    angles.add(environment, "step, longest", "us", *std::max_element(steps_us.begin(), steps_us.end()),
               5000.0);
  }
}

}  // namespace
}  // namespace thermorig::bench

int main(int count, char** arguments) {
  using namespace thermorig::bench;
  const auto options =
      table_options(count, arguments, "thermal_likelihood [--json] [--first-seed N] [--quick]");
  if (!options) return 2;
  std::vector<Row> rows;
  for (int rig = 0; rig < (options->quick ? 1 : 6); ++rig)
    for (const std::string& environment : environments)
      rows.push_back({.environment = environment, .seed = options->first_seed + rows.size()});
  thermorig::on_all_cores(rows.size(), [&](std::size_t i) { judge(rows[i]); });
  std::vector<Figure> figures;
  for (const std::string& environment : environments) add_environment(figures, environment, rows);
  add_speeds(figures, rows);
  add_angles(figures, rows);
  if (options->json) {
    print_json(figures);
    return 0;
  }
  fmt::print("Simulated rigs in virtual time, world \"honest\", plan \"paper\"; from seed {} on.\n",
             options->first_seed);
  print_text(figures);
  return 0;
}
