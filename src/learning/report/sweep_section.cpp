// SPDX-License-Identifier: MIT
// The paper's two tables and box plots.
#include <fmt/format.h>

#include <cmath>

#include "paper_figures.h"
#include "sections.h"
#include "seed_spread.h"
#include "text.h"

namespace thermorig::report {
namespace {

using nlohmann::json;
using study::SettingSummary;

struct Sweep {
  std::string name;  // of its files
  std::vector<Setting> settings;
  int Setting::*axis;
  std::string axis_name;  // "Nf"
  std::string fixed;      // "Nr = 1"
};

std::string value_text(const StudyView& view, double mse) {
  if (!std::isfinite(mse)) return no_value;
  return fmt::format("{} ({})", mse_text(mse), rate_text(rmse_of(mse, view.label_scale_dps)));
}

std::string paper_text(const std::optional<PaperRow>& row, double PaperRow::*figure) {
  return row ? fmt::format("{:.3f}", (*row).*figure) : no_value;
}

std::string median_cell(const StudyView& view, const SettingSummary* summary) {
  return summary == nullptr ? no_result : value_text(view, median_of(*summary));
}

/// One fold has no spread.
std::string spread_text(const SettingSummary& summary, double iqr) {
  return summary.folds < 2 ? no_value : mse_text(iqr);
}

std::string iqr_cell(const SettingSummary* summary) {
  return summary == nullptr ? no_result : spread_text(*summary, iqr_of(*summary));
}

std::string folds_cell(const StudyView& view, const SettingSummary* thermal, const SettingSummary* fusion) {
  const std::size_t a = thermal == nullptr ? 0 : thermal->folds, b = fusion == nullptr ? 0 : fusion->folds;
  return a == b ? fmt::format("{} of {}", a, view.folds.size())
                : fmt::format("{} / {} of {}", a, b, view.folds.size());
}

std::vector<std::string> setting_row(const StudyView& view, const Sweep& sweep, const Setting& setting) {
  const auto paper = paper_row(setting.frames, setting.reduction);
  const SettingSummary* thermal = view.find(setting, false);
  const SettingSummary* fusion = view.find(setting, true);
  return {std::to_string(setting.*sweep.axis),
          paper_text(paper, &PaperRow::median_thermal),
          paper_text(paper, &PaperRow::median_fusion),
          paper_text(paper, &PaperRow::iqr_thermal),
          paper_text(paper, &PaperRow::iqr_fusion),
          median_cell(view, thermal),
          median_cell(view, fusion),
          iqr_cell(thermal),
          iqr_cell(fusion),
          folds_cell(view, thermal, fusion)};
}

/// What no network is needed for: the same number stands beside both set-ups.
std::vector<std::string> baseline_row(const StudyView& view, const std::string& name) {
  const SettingSummary* summary = view.find_any(view.reference);
  const std::string median = summary == nullptr ? no_result : value_text(view, summary->mse[name].median);
  const std::string iqr = summary == nullptr ? no_result : spread_text(*summary, summary->mse[name].iqr);
  return {fmt::format("{} (Nf = {})", name, view.reference.frames),
          no_value,
          no_value,
          no_value,
          no_value,
          median,
          median,
          iqr,
          iqr,
          summary == nullptr ? no_value : fmt::format("{} of {}", summary->folds, view.folds.size())};
}

Table paper_table(const StudyView& view, const Sweep& sweep) {
  Table table;
  table.name = sweep.name;
  table.caption = fmt::format("Test MSE over folds at {}, in the paper's layout (in brackets: RMSE in deg/s)",
                              sweep.fixed);
  table.groups = {{"", 1}, {"paper, real data", 4}, {view.ours(), 5}};
  table.header = {sweep.axis_name};
  for (int side = 0; side < 2; ++side)
    for (const char* column : {"median thermal-only", "median fusion", "IQR thermal-only", "IQR fusion"})
      table.header.emplace_back(column);
  table.header.emplace_back("folds");
  for (const Setting& setting : sweep.settings) table.rows.push_back(setting_row(view, sweep, setting));
  for (const std::string& name : view.baselines) table.rows.push_back(baseline_row(view, name));
  return table;
}

const SettingSummary* summary_for(const StudyView& view, const Setting& setting, const std::string& name) {
  if (name == study::thermal_name) return view.find(setting, false);
  return name == study::fusion_name ? view.find(setting, true) : view.find_any(setting);
}

Table estimator_table(const StudyView& view, const Sweep& sweep) {
  Table table;
  table.name = sweep.name + "-estimators";
  table.caption =
      fmt::format("All estimators on the same windows, {}: median MSE (RMSE in deg/s), IQR", view.ours());
  table.header = {"estimator"};
  for (const Setting& setting : sweep.settings)
    table.header.push_back(fmt::format("{} = {}", sweep.axis_name, setting.*sweep.axis));
  for (const std::string& name : view.estimators) {
    std::vector<std::string> row{name};
    for (const Setting& setting : sweep.settings) {
      const SettingSummary* summary = summary_for(view, setting, name);
      row.push_back(summary == nullptr ? no_result
                                       : value_text(view, summary->mse[name].median) + ", IQR\u00a0" +
                                             spread_text(*summary, summary->mse[name].iqr));
    }
    table.rows.push_back(row);
  }
  return table;
}

json fold_points(const StudyView& view, const Sweep& sweep, bool fusion) {
  json points = json::array();
  for (const Setting& setting : sweep.settings) {
    json folds = json::array();
    for (const study::JobResult* result : view.jobs(setting, fusion)) {
      const auto& errors = result->evaluation.errors[estimator_of(fusion)];
      folds.push_back({{"fold", clean(result->job.test)}, {"mse", drawn(errors.mse)}});
    }
    points.push_back(folds);
  }
  return points;
}

json baseline_lines(const StudyView& view, const Sweep& sweep) {
  json lines = json::array();
  for (const std::string& name : view.baselines) {
    json values = json::array();
    for (const Setting& setting : sweep.settings) {
      const SettingSummary* summary = view.find_any(setting);
      values.push_back(summary == nullptr ? json(nullptr) : drawn(summary->mse[name].median));
    }
    lines.push_back({{"name", name + " (median)"}, {"key", name}, {"values", values}});
  }
  return lines;
}

json paper_medians(const Sweep& sweep, bool fusion) {
  json values = json::array();
  for (const Setting& setting : sweep.settings) {
    const auto row = paper_row(setting.frames, setting.reduction);
    values.push_back(row ? json(fusion ? row->median_fusion : row->median_thermal) : json(nullptr));
  }
  return {{"name", fmt::format("paper, real data: {} (median)", fusion ? "fusion" : "thermal-only")},
          {"key", estimator_of(fusion)},
          {"values", values}};
}

Chart box_chart(const StudyView& view, const Sweep& sweep) {
  Chart chart;
  chart.name = sweep.name;
  chart.title =
      fmt::format("Test MSE over folds against {} at {} ({})", sweep.axis_name, sweep.fixed, view.ours());
  chart.label = fmt::format(
      "Box plots of the test MSE over {} folds against {}, thermal-only beside fusion, "
      "with each fold as a point. The figures stand in the tables below.",
      view.folds.size(), sweep.axis_name);
  json categories = json::array();
  for (const Setting& setting : sweep.settings) categories.push_back(std::to_string(setting.*sweep.axis));
  chart.data = {
      {"kind", "boxes"},
      {"axis", fmt::format("{} ({})", sweep.axis_name, sweep.fixed)},
      {"unit", "test MSE"},
      {"scale", view.label_scale_dps},
      {"categories", categories},
      {"boxes",
       {{{"name", "thermal-only"}, {"key", study::thermal_name}, {"points", fold_points(view, sweep, false)}},
        {{"name", "fusion"}, {"key", study::fusion_name}, {"points", fold_points(view, sweep, true)}}}},
      {"lines", baseline_lines(view, sweep)},
      {"paper", {paper_medians(sweep, false), paper_medians(sweep, true)}}};
  return chart;
}

Section sweep_section(const StudyView& view, const std::string& heading, const Sweep& sweep) {
  return {heading,
          {Charts{{box_chart(view, sweep)}}, paper_table(view, sweep), estimator_table(view, sweep)}};
}

}  // namespace

Section frame_sweep_section(const StudyView& view) {
  return sweep_section(
      view, "Frames of a window (Nf)",
      {"nf", view.frame_sweep(), &Setting::frames, "Nf", fmt::format("Nr = {}", view.reference.reduction)});
}

Section reduction_sweep_section(const StudyView& view) {
  return sweep_section(view, "Resolution (Nr)",
                       {"nr", view.reduction_sweep(), &Setting::reduction, "Nr",
                        fmt::format("Nf = {}", view.reference.frames)});
}

}  // namespace thermorig::report
