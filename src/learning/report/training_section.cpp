// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>

#include "sections.h"
#include "text.h"

namespace thermorig::report {
namespace {

/// Median over folds of the training MSE, epoch by epoch, as far as every fold has it.
std::vector<double> median_curve(const std::vector<const study::JobResult*>& jobs) {
  std::size_t epochs = jobs.empty() ? 0 : jobs.front()->training_mse.size();
  for (const study::JobResult* job : jobs) epochs = std::min(epochs, job->training_mse.size());
  std::vector<double> curve;
  for (std::size_t epoch = 0; epoch < epochs; ++epoch) {
    std::vector<double> folds;
    for (const study::JobResult* job : jobs) folds.push_back(job->training_mse[epoch]);
    curve.push_back(study::spread_of(folds).median);
  }
  return curve;
}

double median_test(const std::vector<const study::JobResult*>& jobs, bool fusion) {
  std::vector<double> folds;
  for (const study::JobResult* job : jobs) folds.push_back(job->evaluation.errors[estimator_of(fusion)].mse);
  return study::spread_of(folds).median;
}

struct Curve {
  bool fusion;
  std::vector<double> mse;
  double test_mse;
};

std::vector<Curve> curves_of(const StudyView& view) {
  std::vector<Curve> curves;
  for (const bool fusion : {false, true}) {
    const auto jobs = view.jobs(view.reference, fusion);
    const auto curve = median_curve(jobs);
    if (!curve.empty()) curves.push_back({fusion, curve, median_test(jobs, fusion)});
  }
  return curves;
}

Chart curve_chart(const std::vector<Curve>& curves) {
  Chart chart;
  chart.name = "training";
  chart.title = "Training MSE by epoch (median over folds)";
  chart.label = "Training MSE against the epoch, a line a set-up:";
  auto lines = nlohmann::json::array();
  for (const Curve& curve : curves) {
    std::vector<double> epochs(curve.mse.size());
    for (std::size_t i = 0; i < epochs.size(); ++i) epochs[i] = static_cast<double>(i + 1);
    const char* name = curve.fusion ? "fusion" : "thermal-only";
    chart.label +=
        fmt::format(" {} from {} to {};", name, mse_text(curve.mse.front()), mse_text(curve.mse.back()));
    lines.push_back(
        {{"name", name}, {"key", estimator_of(curve.fusion)}, {"x", drawn(epochs)}, {"y", drawn(curve.mse)}});
  }
  chart.label.back() = '.';
  chart.data = {{"kind", "lines"}, {"x", "epoch"},   {"y", "training MSE"},
                {"log", true},     {"points", true}, {"lines", lines}};
  return chart;
}

}  // namespace

Section training_section(const StudyView& view) {
  const auto curves = curves_of(view);
  if (curves.empty()) return {"Training", {Paragraph{"No training curve at " + view.reference_text() + "."}}};
  Table table;
  table.name = "training";
  table.caption = "Training at " + view.reference_text() +
                  ": median MSE over folds, first and last epoch, beside the test's";
  table.header = {"set-up", "epochs", "first epoch", "last epoch", "test", "test / last epoch"};
  for (const Curve& curve : curves)
    table.rows.push_back(
        {curve.fusion ? "fusion" : "thermal-only", std::to_string(curve.mse.size()),
         mse_text(curve.mse.front()), mse_text(curve.mse.back()), mse_text(curve.test_mse),
         curve.mse.back() > 0.0 ? fmt::format("{:.1f}", curve.test_mse / curve.mse.back()) : no_value});
  return {"Training", {Charts{{curve_chart(curves)}}, table}};
}

}  // namespace thermorig::report
