// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include "paper_figures.h"
#include "sections.h"
#include "text.h"

namespace thermorig::report {
namespace {

using nlohmann::json;
using study::SettingSummary;

struct Cost {
  std::string title, name;
  std::uint64_t (*of)(const SettingSummary&);
};

Table cost_table(const StudyView& view) {
  Table table;
  table.name = "cost";
  table.caption = "Cost of one window";
  table.groups = {{"", 1}, {"thermal-only", 2}, {"fusion", 2}};
  table.header = {"setting", "weights", "multiply-adds", "weights", "multiply-adds"};
  for (const Setting& setting : view.settings()) {
    std::vector<std::string> row{setting_text(setting.frames, setting.reduction)};
    for (const bool fusion : {false, true}) {
      const SettingSummary* summary = view.find(setting, fusion);
      row.push_back(summary == nullptr ? no_result : count_text(summary->weights));
      row.push_back(summary == nullptr ? no_result : count_text(summary->multiply_adds));
    }
    table.rows.push_back(row);
  }
  return table;
}

Chart cost_chart(const StudyView& view, const Cost& cost) {
  Chart chart;
  chart.name = cost.name;
  chart.title = fmt::format("{} against Nr, Nf = {}", cost.title, view.reference.frames);
  chart.label = chart.title + ":";
  json categories = json::array(), thermal = json::array(), fusion = json::array();
  for (const Setting& setting : view.reduction_sweep()) {
    if (view.find_any(setting) == nullptr) continue;
    categories.push_back(std::to_string(setting.reduction));
    for (const bool fused : {false, true}) {
      const SettingSummary* summary = view.find(setting, fused);
      (fused ? fusion : thermal).push_back(summary == nullptr ? json(nullptr) : json(cost.of(*summary)));
      if (summary != nullptr)
        chart.label += fmt::format(" Nr = {} {} {};", setting.reduction, fused ? "fusion" : "thermal-only",
                                   count_text(cost.of(*summary)));
    }
  }
  chart.label.back() = '.';
  chart.data = {{"kind", "bars"},
                {"x", "Nr"},
                {"y", cost.title},
                {"categories", categories},
                {"bars",
                 {{{"name", "thermal-only"}, {"key", study::thermal_name}, {"values", thermal}},
                  {{"name", "fusion"}, {"key", study::fusion_name}, {"values", fusion}}}}};
  return chart;
}

}  // namespace

Section cost_section(const StudyView& view) {
  const Cost weights{"Weights", "weights",
                     [](const SettingSummary& s) -> std::uint64_t { return s.weights; }};
  const Cost adds{"Multiply-adds of one window", "cost",
                  [](const SettingSummary& s) -> std::uint64_t { return s.multiply_adds; }};
  return {"Weights and multiply-adds",
          {Charts{{cost_chart(view, weights), cost_chart(view, adds)}}, cost_table(view)}};
}

}  // namespace thermorig::report
