// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "document.h"
#include "thermorig/learning/report/report.h"

namespace thermorig::report {

/// The document's charts and tables, each in files of its own, as study_plots() says.
std::vector<PlotFile> plots_of(const Document& document, bool simulated);

}  // namespace thermorig::report
