// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>

#include "drift_figures.h"
#include "sections.h"
#include "text.h"

namespace thermorig::report {
namespace {

std::string drift_cell(const FoldDrift& drift) {
  return fmt::format("{} ({})", rate_text(drift.deg_per_min), angle_text(drift.worst_deg));
}

Table drift_table(const StudyView& view, DriftFrom from) {
  Table table;
  table.name = from == DriftFrom::settled ? "drift-settled" : "drift";
  table.caption = fmt::format(
      "Drift in deg/min and, in brackets, the worst angle error in deg{} at {}, "
      "{}",
      from == DriftFrom::settled ? fmt::format(", from {:.0f} s on,", study::AngleTrack::settled_s) : "",
      view.reference_text(), view.ours());
  table.header = {"fold"};
  table.header.insert(table.header.end(), view.estimators.begin(), view.estimators.end());
  for (const std::string& fold : view.folds) {
    std::vector<std::string> row{clean(fold)};
    for (const std::string& name : view.estimators)
      row.push_back(drift_cell(drift_of(view, name, fold, from)));
    table.rows.push_back(row);
  }
  std::vector<std::string> last{"median |drift| (worst of all)"};
  for (const std::string& name : view.estimators) {
    const DriftSummary drift = drift_summary(view, name, from);
    last.push_back(drift_cell({drift.median_deg_per_min, drift.worst_deg}));
  }
  table.rows.push_back(last);
  return table;
}

/// Results of before have no angles from then on.
bool has_settled(const StudyView& view) {
  return std::ranges::any_of(view.estimators, [&](const std::string& name) {
    return drift_summary(view, name, DriftFrom::settled).folds > 0;
  });
}

std::vector<EstimatorTrack> tracks_of(const StudyView& view, const std::string& fold) {
  std::vector<EstimatorTrack> tracks;
  for (const std::string& name : view.estimators)
    if (const study::AngleTrack* track = track_of(view, name, fold)) tracks.push_back({name, track});
  return tracks;
}

}  // namespace

Chart angle_chart(const std::string& title, const std::vector<EstimatorTrack>& tracks) {
  Chart chart;
  chart.name = "angle";
  chart.title = title;
  chart.label = "Error of the integrated angle over time, a line an estimator. Drift and worst error:";
  auto lines = nlohmann::json::array();
  for (const auto& [name, track] : tracks) {
    if (track->error_deg[name].empty()) continue;
    chart.label += fmt::format(" {} {} deg/min, {} deg;", name, rate_text(track->drift_deg_per_min[name]),
                               angle_text(track->worst_deg[name]));
    lines.push_back(
        {{"name", name}, {"key", name}, {"x", drawn(track->time_s)}, {"y", drawn(track->error_deg[name])}});
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
  Section section{
      "Angle by integration",
      {Paragraph{"Speeds integrated over the time of the windows, less the commanded angle (paper, Fig. 6). "
                 "Where no window is valid, as in turn-arounds, nothing is integrated for any of them."},
       charts, drift_table(view, DriftFrom::first)}};
  if (has_settled(view)) section.blocks.push_back(drift_table(view, DriftFrom::settled));
  return section;
}

}  // namespace thermorig::report
