// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include "gain_figures.h"
#include "paper_figures.h"
#include "sections.h"
#include "text.h"

namespace thermorig::report {
namespace {

std::string two_digits(double value) {
  return fmt::format("{:.2f}", value);
}

std::vector<std::string> gain_row(std::vector<std::string> row, const study::GainStatistics& gain) {
  row.insert(row.end(), {two_digits(gain.mean), two_digits(gain.deviation), two_digits(gain.median),
                         share_text(gain.below_002), share_text(gain.above_098),
                         fmt::format("{:.3f}", peak_of(gain)), gate_text(gain)});
  return row;
}

Table gain_table(const StudyView& view) {
  Table table;
  table.name = "kg";
  table.caption = "Kg over all test windows of all folds, " + view.ours();
  table.header = {"setting", "seed", "mean", "sd", "median", "below 0.02", "above 0.98", "peak", "gate"};
  for (const study::SettingSummary& summary : view.summaries)
    if (summary.fusion && summary.gain.windows() > 0)
      table.rows.push_back(gain_row(
          {setting_text(summary.frames, summary.reduction), std::to_string(summary.seed)}, summary.gain));
  return table;
}

Table fold_table(const StudyView& view) {
  Table table;
  table.name = "kg-folds";
  table.caption = fmt::format("Kg fold by fold at {}, seed {}", view.reference_text(), view.table_seed);
  table.header = {"fold", "mean", "sd", "median", "below 0.02", "above 0.98", "peak", "gate"};
  for (const study::JobResult* result : view.jobs(view.reference, true))
    if (result->evaluation.gain.windows() > 0)
      table.rows.push_back(gain_row({clean(result->job.test)}, result->evaluation.gain));
  return table;
}

}  // namespace

Chart gain_chart(const std::string& title, const study::GainStatistics& gain) {
  Chart chart;
  chart.name = "kg";
  chart.title = fmt::format("{}: mean {:.2f}", title, gain.mean);
  chart.label = fmt::format("Histogram of Kg over {} windows: mean {:.2f}, peak at {:.3f}.",
                            count_text(gain.windows()), gain.mean, peak_of(gain));
  chart.data = {
      {"kind", "histogram"}, {"axis", "Kg"}, {"counts", gain.histogram}, {"mean", drawn(gain.mean)}};
  return chart;
}

Section gate_section(const StudyView& view) {
  Section section{
      "The gate Kg",
      {Paragraph{fmt::format("y = Kg y_th + (1 - Kg) y_gy: at Kg = 0 the network only repeats its "
                             "gyro, at Kg = 1 the gyro is not used. The paper's histogram (Fig. 3, "
                             "real data) peaks near {:.2f}.",
                             paper_gain_peak)}}};
  const study::SettingSummary* reference = view.find(view.reference, true);
  if (reference != nullptr && reference->gain.windows() > 0)
    section.blocks.push_back(
        Charts{{gain_chart("Kg at " + view.reference_text() + " (" + view.ours() + ")", reference->gain)}});
  const Table table = gain_table(view), folds = fold_table(view);
  if (table.rows.empty()) return {"The gate Kg", {Paragraph{"No result of fusion, so no gate."}}};
  section.blocks.push_back(table);
  if (!folds.rows.empty()) section.blocks.push_back(folds);
  return section;
}

}  // namespace thermorig::report
