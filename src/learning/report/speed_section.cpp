// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "sections.h"
#include "text.h"

namespace thermorig::report {
namespace {

using study::SpeedErrors;

/// Squared errors of several parts added up, each with its windows; parts without a figure are left out.
struct PooledMse {
  double sum = 0.0;
  std::uint64_t windows = 0;
  void add(double mse, std::uint64_t count) {
    if (!std::isfinite(mse)) return;
    sum += mse * static_cast<double>(count);
    windows += count;
  }
  double mse() const { return windows == 0 ? unknown : sum / static_cast<double>(windows); }
};

struct PooledSpeed {
  std::uint64_t windows = 0;
  study::PerEstimator<PooledMse> errors;
};

/// By signed speed, over the folds at the reference setting, each estimator's of StudyView::job_of().
std::vector<SpeedErrors> pooled_speeds(const StudyView& view) {
  std::map<double, PooledSpeed> pooled;
  for (const std::string& fold : view.folds) {
    const study::JobResult* any = view.job_of(study::gyro_name, fold);
    if (any == nullptr) continue;
    for (const SpeedErrors& speed : any->evaluation.speeds) pooled[speed.rate_dps].windows += speed.windows;
    for (const std::string& name : view.estimators)
      if (const study::JobResult* result = view.job_of(name, fold))
        for (const SpeedErrors& speed : result->evaluation.speeds)
          pooled[speed.rate_dps].errors[name].add(speed.mse[name], speed.windows);
  }
  std::vector<SpeedErrors> speeds;
  for (const auto& [rate_dps, sums] : pooled) {
    SpeedErrors speed{rate_dps, sums.windows};
    for (const std::string& name : view.estimators) speed.mse[name] = sums.errors[name].mse();
    speeds.push_back(speed);
  }
  return speeds;
}

struct Magnitude {
  std::uint64_t negative = 0, positive = 0;
  study::PerEstimator<PooledMse> errors;
};

Table magnitude_table(const std::vector<SpeedErrors>& speeds, double label_scale_dps,
                      std::span<const std::string> estimators) {
  std::map<double, Magnitude> magnitudes;
  for (const SpeedErrors& speed : speeds) {
    Magnitude& magnitude = magnitudes[std::abs(speed.rate_dps)];
    (speed.rate_dps < 0.0 ? magnitude.negative : magnitude.positive) += speed.windows;
    for (const std::string& name : estimators) magnitude.errors[name].add(speed.mse[name], speed.windows);
  }
  Table table;
  table.name = "speed";
  table.caption = "Windows and RMSE in deg/s by commanded speed";
  table.folded = magnitudes.size() > 8;
  table.groups = {{"", 1}, {"windows", 2}, {"RMSE, deg/s", estimators.size()}};
  table.header = {"|speed|, deg/s", "negative", "positive"};
  table.header.insert(table.header.end(), estimators.begin(), estimators.end());
  for (const auto& [rate_dps, magnitude] : magnitudes) {
    std::vector<std::string> row{fmt::format("{:g}", rate_dps), count_text(magnitude.negative),
                                 count_text(magnitude.positive)};
    for (const std::string& name : estimators)
      row.push_back(rate_text(std::sqrt(magnitude.errors[name].mse()) * label_scale_dps));
    table.rows.push_back(row);
  }
  return table;
}

Chart speed_chart(const std::vector<SpeedErrors>& speeds, double label_scale_dps,
                  std::span<const std::string> estimators) {
  Chart chart;
  chart.name = "speed";
  chart.title = "RMSE by commanded speed";
  chart.label = fmt::format(
      "RMSE in deg/s against the commanded speed, {} speeds, a line an estimator. The "
      "figures stand in the table below.",
      speeds.size());
  auto lines = nlohmann::json::array();
  for (const std::string& name : estimators) {
    std::vector<double> x, y;
    for (const SpeedErrors& speed : speeds) {
      x.push_back(speed.rate_dps);
      y.push_back(std::sqrt(speed.mse[name]) * label_scale_dps);
    }
    lines.push_back({{"name", name}, {"key", name}, {"x", drawn(x)}, {"y", drawn(y)}});
  }
  chart.data = {{"kind", "lines"},
                {"x", "commanded speed, deg/s"},
                {"y", "RMSE, deg/s"},
                {"points", true},
                {"lines", lines}};
  return chart;
}

}  // namespace

std::vector<Block> speed_blocks(const std::vector<SpeedErrors>& speeds, double label_scale_dps,
                                std::span<const std::string> estimators) {
  if (speeds.empty()) return {Paragraph{"No windows with a speed."}};
  const auto [least, most] =
      std::minmax_element(speeds.begin(), speeds.end(),
                          [](const SpeedErrors& a, const SpeedErrors& b) { return a.windows < b.windows; });
  std::uint64_t windows = 0;
  for (const SpeedErrors& speed : speeds) windows += speed.windows;
  return {Paragraph{fmt::format("{} test windows at {} speeds: from {} at {:g} deg/s to {} at {:g} deg/s.",
                                count_text(windows), speeds.size(), count_text(least->windows),
                                least->rate_dps, count_text(most->windows), most->rate_dps)},
          Charts{{speed_chart(speeds, label_scale_dps, estimators)}},
          magnitude_table(speeds, label_scale_dps, estimators)};
}

Section speed_section(const StudyView& view) {
  return {"Error by speed, " + view.reference_text(),
          speed_blocks(pooled_speeds(view), view.label_scale_dps, view.estimators)};
}

}  // namespace thermorig::report
