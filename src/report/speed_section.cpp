// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "sections.h"
#include "text.h"

namespace thermorig::report {
namespace {

using study::Estimator;
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
  double mse() const {
    return windows == 0 ? std::numeric_limits<double>::quiet_NaN() : sum / static_cast<double>(windows);
  }
};

struct PooledSpeed {
  std::uint64_t windows = 0;
  std::array<PooledMse, study::estimator_count> errors{};
};

/// By signed speed, over the folds at the reference setting: thermal-only of its own network, the rest of the
/// fused one, or of either where only one has results.
std::vector<SpeedErrors> pooled_speeds(const StudyView& view) {
  std::map<double, PooledSpeed> pooled;
  for (const std::string& fold : view.folds) {
    const study::JobResult* thermal = view.job(view.reference, false, fold);
    const study::JobResult* fusion = view.job(view.reference, true, fold);
    const study::JobResult* any = fusion != nullptr ? fusion : thermal;
    if (any == nullptr) continue;
    for (const SpeedErrors& speed : any->evaluation.speeds) {
      pooled[speed.rate_dps].windows += speed.windows;
      for (const Estimator estimator : {Estimator::fusion, Estimator::gyro, Estimator::gyro_unbiased}) {
        const auto index = static_cast<std::size_t>(estimator);
        pooled[speed.rate_dps].errors[index].add(speed.mse[index], speed.windows);
      }
    }
    if (thermal == nullptr) continue;
    for (const SpeedErrors& speed : thermal->evaluation.speeds)
      pooled[speed.rate_dps].errors[0].add(speed.mse[0], speed.windows);
  }
  std::vector<SpeedErrors> speeds;
  for (const auto& [rate_dps, sums] : pooled) {
    SpeedErrors speed{rate_dps, sums.windows, {}};
    for (std::size_t i = 0; i < study::estimator_count; ++i) speed.mse[i] = sums.errors[i].mse();
    speeds.push_back(speed);
  }
  return speeds;
}

struct Magnitude {
  std::uint64_t negative = 0, positive = 0;
  std::array<PooledMse, study::estimator_count> errors{};
};

Table magnitude_table(const std::vector<SpeedErrors>& speeds, double label_scale_dps,
                      const std::vector<Estimator>& estimators) {
  std::map<double, Magnitude> magnitudes;
  for (const SpeedErrors& speed : speeds) {
    Magnitude& magnitude = magnitudes[std::abs(speed.rate_dps)];
    (speed.rate_dps < 0.0 ? magnitude.negative : magnitude.positive) += speed.windows;
    for (std::size_t i = 0; i < study::estimator_count; ++i)
      magnitude.errors[i].add(speed.mse[i], speed.windows);
  }
  Table table;
  table.caption = "Windows and RMSE in deg/s by commanded speed";
  table.folded = magnitudes.size() > 8;
  table.groups = {{"", 1}, {"windows", 2}, {"RMSE, deg/s", estimators.size()}};
  table.header = {"|speed|, deg/s", "negative", "positive"};
  for (const Estimator estimator : estimators) table.header.push_back(label_of(estimator));
  for (const auto& [rate_dps, magnitude] : magnitudes) {
    std::vector<std::string> row{fmt::format("{:g}", rate_dps), count_text(magnitude.negative),
                                 count_text(magnitude.positive)};
    for (const Estimator estimator : estimators) {
      const double mse = magnitude.errors[static_cast<std::size_t>(estimator)].mse();
      row.push_back(rate_text(std::sqrt(mse) * label_scale_dps));
    }
    table.rows.push_back(row);
  }
  return table;
}

Chart speed_chart(const std::vector<SpeedErrors>& speeds, double label_scale_dps,
                  const std::vector<Estimator>& estimators) {
  Chart chart;
  chart.title = "RMSE by commanded speed";
  chart.label = fmt::format(
      "RMSE in deg/s against the commanded speed, {} speeds, a line an estimator. The "
      "figures stand in the table below.",
      speeds.size());
  auto lines = nlohmann::json::array();
  for (const Estimator estimator : estimators) {
    std::vector<double> x, y;
    for (const SpeedErrors& speed : speeds) {
      x.push_back(speed.rate_dps);
      y.push_back(std::sqrt(speed.mse[static_cast<std::size_t>(estimator)]) * label_scale_dps);
    }
    lines.push_back(
        {{"name", label_of(estimator)}, {"key", series_key(estimator)}, {"x", drawn(x)}, {"y", drawn(y)}});
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
                                const std::vector<Estimator>& estimators) {
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
  const std::vector<Estimator> estimators(study::all_estimators.begin(), study::all_estimators.end());
  return {"Error by speed, " + view.reference_text(),
          speed_blocks(pooled_speeds(view), view.label_scale_dps, estimators)};
}

}  // namespace thermorig::report
