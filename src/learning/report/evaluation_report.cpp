// SPDX-License-Identifier: MIT
// A model on sessions.
#include <fmt/format.h>

#include "gain_figures.h"
#include "html.h"
#include "json_values.h"
#include "markdown.h"
#include "plots.h"
#include "sections.h"
#include "text.h"
#include "thermorig/learning/report/report.h"

namespace thermorig::report {
namespace {

using model::Model;
using study::Evaluation;

std::vector<std::string> estimators_of(const Model& model) {
  std::vector<std::string> names(study::all_estimators().begin(), study::all_estimators().end());
  if (!model.weights.shape.fusion) std::erase(names, study::fusion_name);
  return names;
}

std::string names_of(const std::vector<model::Provenance::Data>& data) {
  std::string text;
  for (const auto& entry : data) text += (text.empty() ? "" : ", ") + clean(entry.name);
  return text.empty() ? "none" : text;
}

Section model_section(const Model& model) {
  const network::Shape& shape = model.weights.shape;
  const model::Provenance& from = model.provenance;
  Table table;
  table.name = "model";
  table.header = {"what", "value"};
  table.rows = {
      {"network", fmt::format("{}, {}", setting_text(shape.frames, shape.reduction),
                              shape.fusion ? "fusion" : "thermal-only")},
      {"weights", count_text(network::weight_count(shape))},
      {"multiply-adds of a window", count_text(network::multiply_adds(shape))},
      {"made by", clean(from.producer)},
      {"preset", clean(from.preset)},
      {"label", from.label ? column_of(*from.label) : ""},
      {"seed", std::to_string(from.seed)},
      {"epochs trained, kept", fmt::format("{}, {}", from.epochs, from.epoch_kept)},
      {"trained on", fmt::format("{}{}", from.simulated ? "SIMULATED data: " : "", names_of(from.training))},
      {"held out to choose the epoch", names_of(from.held_out)},
      {"made-up windows shown", from.made_windows > 0 ? count_text(from.made_windows) : ""},
      {"begun from", clean(from.begun_from)},
      {"licence of the training data", clean(from.data_licence)}};
  std::erase_if(table.rows, [](const auto& row) { return row[1].empty(); });
  return {"The model", {table}};
}

Table errors_table(const Model& model, const study::PerEstimator<study::Errors>& by_estimator,
                   const char* truth, const char* name) {
  Table table;
  table.name = name;
  table.caption =
      fmt::format("Errors over all windows against {} (MSE: (speed / {:g} deg/s)^2; the rest in deg/s)",
                  truth, model.scaling.label_scale_dps);
  table.header = {"estimator",       "windows",        "MSE",       "RMSE", "median |error|",
                  "95th percentile", "above 30 deg/s", "mean error"};
  for (const std::string& estimator : estimators_of(model)) {
    const study::Errors& errors = by_estimator[estimator];
    table.rows.push_back({estimator, count_text(errors.windows), mse_text(errors.mse),
                          rate_text(errors.rmse_dps), rate_text(errors.median_dps), rate_text(errors.p95_dps),
                          share_text(errors.outlier_share), rate_text(errors.mean_error_dps)});
  }
  return table;
}

Section errors_section(const Model& model, const Evaluation& evaluation) {
  return {"Errors",
          {errors_table(model, evaluation.errors, "the commanded speed", "errors"),
           errors_table(model, evaluation.shaft_errors, "the shaft, by the servo model", "errors-shaft")}};
}

Section bounds_section(const Model& model, const study::BoundErrors& bounds) {
  Table table;
  table.name = "bound";
  table.caption = fmt::format(
      "Errors in units of the Cramer-Rao bound of each window's images: median {} deg/s over {} windows, "
      "below "
      "{:g} deg/s in {}",
      rate_text(bounds.median_dps), count_text(bounds.windows), study::BoundErrors::well_told_dps,
      count_text(bounds.well_told));
  table.header = {"estimator", "median error", "RMSE where the bound is below 2 deg/s"};
  for (const std::string& name : estimators_of(model))
    table.rows.push_back({name, rate_text(bounds.median[name]), rate_text(bounds.well_told_rmse[name])});
  return {"Beside the bound", {table}};
}

Section gain_section(const study::GainStatistics& gain) {
  return {
      "The gate Kg",
      {Charts{{gain_chart("Kg over all windows", gain)}},
       Paragraph{fmt::format("Mean {:.2f}, standard deviation {:.2f}, median {:.2f}; {} below 0.02, {} above "
                             "0.98: {}.",
                             gain.mean, gain.deviation, gain.median, share_text(gain.below_002),
                             share_text(gain.above_098), gate_text(gain))}}};
}

std::vector<std::string> sigma_row(const std::string& name, const study::GateSigma& sigma) {
  return {name,
          rate_text(sigma.median_dps),
          share_text(sigma.within_one),
          share_text(sigma.within_two),
          fmt::format("{:.2f} to {:.2f}", sigma.gain_p05, sigma.gain_p95),
          rate_text(sigma.fusion_rmse_dps)};
}

Section sigma_section(const Evaluation& evaluation) {
  Table table;
  table.name = "sigma";
  table.caption = fmt::format(
      "Standard deviation that Kg states for the rate from the images, and how many errors against the shaft "
      "lie within it; fusion: expected RMSE beside a gyro that is off by {:g} deg/s",
      study::expected_gyro_dps);
  table.header = {"environment", "median sigma, deg/s", "within one",
                  "within two",  "Kg, 5 to 95 %",       "fusion RMSE"};
  for (const study::EnvironmentErrors& environment : evaluation.environments)
    if (environment.sigma) table.rows.push_back(sigma_row(clean(environment.name), *environment.sigma));
  table.rows.push_back(sigma_row("all", *evaluation.sigma));
  return {"The sigma that the gate states", {table}};
}

std::vector<EstimatorTrack> tracks_of(const study::AngleTrack& track,
                                      const std::vector<std::string>& estimators) {
  std::vector<EstimatorTrack> tracks;
  for (const std::string& name : estimators) tracks.push_back({name, &track});
  return tracks;
}

Section angles_section(const Model& model, const Evaluation& evaluation) {
  const auto estimators = estimators_of(model);
  Charts charts;
  charts.small = evaluation.angles.size() > 2;
  Table table;
  table.name = "drift";
  table.caption = "Drift in deg/min and, in brackets, the worst angle error in deg";
  table.header = {"acquisition"};
  table.header.insert(table.header.end(), estimators.begin(), estimators.end());
  for (std::size_t i = 0; i < evaluation.angles.size(); ++i) {
    const study::AngleTrack& track = evaluation.angles[i];
    const std::string title =
        i < evaluation.names.size() ? clean(evaluation.names[i]) : std::to_string(i + 1);
    charts.charts.push_back(angle_chart(title, tracks_of(track, estimators)));
    std::vector<std::string> row{title};
    for (const std::string& name : estimators)
      row.push_back(fmt::format("{} ({})", rate_text(track.drift_deg_per_min[name]),
                                angle_text(track.worst_deg[name])));
    table.rows.push_back(row);
  }
  return {"Angle by integration", {charts, table}};
}

Section speeds_section(const Model& model, const Evaluation& evaluation) {
  return {"Error by speed",
          speed_blocks(evaluation.speeds, model.scaling.label_scale_dps, estimators_of(model))};
}

/// Empty if all is real.
std::string simulated_text(const Model& model, const Evaluation& evaluation) {
  if (model.provenance.simulated && evaluation.simulated)
    return "The model was trained on SIMULATED data, and is tested on SIMULATED data.";
  if (model.provenance.simulated) return "The model was trained on SIMULATED data.";
  return evaluation.simulated ? "The model is tested on SIMULATED data." : "";
}

Document document_of(const Model& model, const Evaluation& evaluation) {
  Document document;
  document.title = "A model on sessions";
  document.banner = simulated_text(model, evaluation);
  document.sections = {errors_section(model, evaluation), speeds_section(model, evaluation)};
  if (evaluation.bounds) document.sections.push_back(bounds_section(model, *evaluation.bounds));
  if (evaluation.gain.windows() > 0) document.sections.push_back(gain_section(evaluation.gain));
  if (evaluation.sigma) document.sections.push_back(sigma_section(evaluation));
  if (!evaluation.angles.empty()) document.sections.push_back(angles_section(model, evaluation));
  document.sections.push_back(model_section(model));
  return document;
}

}  // namespace

std::string evaluation_markdown(const Model& model, const Evaluation& evaluation) {
  return markdown_of(document_of(model, evaluation));
}

std::string evaluation_html(const Model& model, const Evaluation& evaluation) {
  return html_of(document_of(model, evaluation));
}

std::vector<PlotFile> evaluation_plots(const Model& model, const Evaluation& evaluation) {
  return plots_of(document_of(model, evaluation), !simulated_text(model, evaluation).empty());
}

std::string evaluation_json(const Model& model, const Evaluation& evaluation) {
  using nlohmann::json;
  const network::Shape& shape = model.weights.shape;
  json environments = json::array(), angles = json::array();
  for (const study::EnvironmentErrors& environment : evaluation.environments) {
    environments.push_back({{"name", environment.name},
                            {"acquisitions", environment.acquisitions},
                            {"errors", errors_json(environment.errors)},
                            {"shaft_errors", errors_json(environment.shaft_errors)}});
    if (environment.sigma) environments.back()["sigma"] = sigma_json(*environment.sigma);
  }
  for (std::size_t i = 0; i < evaluation.angles.size(); ++i) {
    angles.push_back(drift_json(evaluation.angles[i]));
    if (i < evaluation.names.size()) angles.back()["name"] = evaluation.names[i];
  }
  json report{{"format", "thermorig-evaluation-report"},
              {"version", 3},
              {"model",
               {{"frames", shape.frames},
                {"reduction", shape.reduction},
                {"fusion", shape.fusion},
                {"weights", network::weight_count(shape)},
                {"multiply_adds", network::multiply_adds(shape)},
                {"preset", model.provenance.preset},
                {"label", model.provenance.label ? json(name_of(*model.provenance.label)) : json()},
                {"seed", model.provenance.seed},
                {"simulated", model.provenance.simulated}}},
              {"label_scale_dps", model.scaling.label_scale_dps},
              {"acquisitions", evaluation.names},
              {"errors", errors_json(evaluation.errors)},
              {"shaft_errors", errors_json(evaluation.shaft_errors)},
              {"environments", environments},
              {"speeds", speeds_json(evaluation.speeds)},
              {"gain", gain_json(evaluation.gain)},
              {"angles", angles}};
  if (evaluation.sigma) report["sigma"] = sigma_json(*evaluation.sigma);
  if (evaluation.bounds) report["bounds"] = bounds_json(*evaluation.bounds);
  return json_text(report);
}

}  // namespace thermorig::report
