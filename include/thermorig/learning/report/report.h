// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <string>
#include <vector>

#include "thermorig/learning/study/study.h"
#include "thermorig/network/model/model.h"
#include "thermorig/storage/session/rows.h"

namespace thermorig::report {

/// Whether the HTML texts draw their charts: node was there when the program was built. They say so
/// themselves.
bool draws_charts();
/// Throws Error(failed) if they do not.
void require_charts();

/// A chart or a table in a file of its own, for somebody's thesis.
struct PlotFile {
  std::string name;  // "fig-nf.svg", "table-nf.tex", "table-nf.csv", "captions.csv"
  std::string text;
};

// A study's results, drawn again from its result files at any time.

/// Tables in the paper's layout (Nf and Nr against median and IQR, thermal-only and fusion) beside the
/// paper's own figures, always with the estimators that need no network; gate statistics, drift, cost. Says
/// "simulated" where the data are.
std::string study_markdown(std::span<const study::JobResult> results);

/// The same as one JSON object.
std::string study_json(std::span<const study::JobResult> results);

/// The same as one page that needs nothing else: tables and the paper's plots (box plots, Kg histogram,
/// angle, cost).
std::string study_html(std::span<const study::JobResult> results);

/// All its charts as SVG (fig-nf, fig-nr, fig-kg, fig-angle, fig-cost, ...), and its tables as LaTeX
/// (booktabs) and CSV. Of charts or tables of one name the second is called NAME-2; captions.csv says what
/// each shows. Each figure says so where the data are simulated. Throws Error(failed) if draws_charts() does
/// not.
std::vector<PlotFile> study_plots(std::span<const study::JobResult> results);

// A model on sessions.
std::string evaluation_markdown(const model::Model& model, const study::Evaluation& evaluation);
std::string evaluation_json(const model::Model& model, const study::Evaluation& evaluation);
std::string evaluation_html(const model::Model& model, const study::Evaluation& evaluation);
/// As study_plots(). Simulated: what the model was trained on, or any of the sessions.
std::vector<PlotFile> evaluation_plots(const model::Model& model, const study::Evaluation& evaluation);

/// As study_plots(), of one session: fig-rates and fig-difference over time, fig-image, what its frames lack.
/// `image`: what fig-image shows, as one looks at the scene; no values, no figure.
std::vector<PlotFile> session_plots(const session::Rows& rows, const std::vector<float>& image);

}  // namespace thermorig::report
