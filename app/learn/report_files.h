// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>

namespace thermorig::app {

/// A report in its three forms.
struct ReportTexts {
  std::string markdown, json, html;
};

/// Writes report.md, report.json and report.html into the folder, which is made if need be. Throws
/// Error(storage).
void write_report(const std::filesystem::path& folder, const ReportTexts& texts);

}  // namespace thermorig::app
