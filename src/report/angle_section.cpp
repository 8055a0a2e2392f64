// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include "drift_figures.h"
#include "sections.h"
#include "text.h"

namespace thermorig::report {
namespace {

using study::Estimator;

std::string drift_cell(const FoldDrift& drift) {
  return fmt::format("{} ({})", rate_text(drift.deg_per_min), angle_text(drift.worst_deg));
}

Table drift_table(const StudyView& view) {
  Table table;
  table.caption = fmt::format(
      "Drift in deg/min and, in brackets, the worst angle error in deg at {}, "
      "{}",
      view.reference_text(), view.ours());
  table.header = {"fold"};
  for (const Estimator estimator : study::all_estimators) table.header.push_back(label_of(estimator));
  for (const std::string& fold : view.folds) {
    std::vector<std::string> row{clean(fold)};
    for (const Estimator estimator : study::all_estimators)
      row.push_back(drift_cell(drift_of(view, estimator, fold)));
    table.rows.push_back(row);
  }
  std::vector<std::string> last{"median |drift| (worst of all)"};
  for (const Estimator estimator : study::all_estimators) {
    const DriftSummary drift = drift_summary(view, estimator);
    last.push_back(drift_cell({drift.median_deg_per_min, drift.worst_deg}));
  }
  table.rows.push_back(last);
  return table;
}

std::vector<EstimatorTrack> tracks_of(const StudyView& view, const std::string& fold) {
  std::vector<EstimatorTrack> tracks;
  for (const Estimator estimator : study::all_estimators)
    if (const study::JobResult* result = track_of(view, estimator, fold))
      tracks.push_back({estimator, &result->evaluation.angles.front()});
  return tracks;
}

}  // namespace

Chart angle_chart(const std::string& title, const std::vector<EstimatorTrack>& tracks) {
  Chart chart;
  chart.title = title;
  chart.label = "Error of the integrated angle over time, a line an estimator. Drift and worst error:";
  auto lines = nlohmann::json::array();
  for (const auto& [estimator, track] : tracks) {
    const auto index = static_cast<std::size_t>(estimator);
    if (track->error_deg[index].empty()) continue;
    chart.label +=
        fmt::format(" {} {} deg/min, {} deg;", label_of(estimator),
                    rate_text(track->drift_deg_per_min[index]), angle_text(track->worst_deg[index]));
    lines.push_back({{"name", label_of(estimator)},
                     {"key", series_key(estimator)},
                     {"x", drawn(track->time_s)},
                     {"y", drawn(track->error_deg[index])}});
  }
  chart.label.back() = '.';
  chart.data = {{"kind", "lines"}, {"x", "integrated time, s"}, {"y", "angle error, deg"}, {"lines", lines}};
  return chart;
}

Section angle_section(const StudyView& view) {
  Charts charts;
  charts.small = view.folds.size() > 2;
  for (const std::string& fold : view.folds) {
    const auto tracks = tracks_of(view, fold);
    if (!tracks.empty()) charts.charts.push_back(angle_chart(clean(fold), tracks));
  }
  if (charts.charts.empty())
    return {"Angle by integration", {Paragraph{"No result at " + view.reference_text() + "."}}};
  return {
      "Angle by integration",
      {Paragraph{"Speeds integrated over the time of the windows, less the commanded angle (paper, Fig. 6). "
                 "Where no window is valid, as in turn-arounds, nothing is integrated for any of them."},
       charts, drift_table(view)}};
}

}  // namespace thermorig::report
