// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <string>

#include "thermorig/learning/study/study.h"
#include "thermorig/network/model/model.h"

namespace thermorig::report {

/// Whether the HTML texts draw their charts: node was there when the program was built. They say so
/// themselves.
bool draws_charts();

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

// A model on sessions.
std::string evaluation_markdown(const model::Model& model, const study::Evaluation& evaluation);
std::string evaluation_json(const model::Model& model, const study::Evaluation& evaluation);
std::string evaluation_html(const model::Model& model, const study::Evaluation& evaluation);

}  // namespace thermorig::report
