// SPDX-License-Identifier: MIT
#include "report_files.h"

#include "thermorig/core/error.h"
#include "thermorig/files/whole_file.h"

namespace thermorig::app {

void write_report(const std::filesystem::path& folder, const ReportTexts& texts) {
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure)
    throw Error(ExitCode::storage, "cannot make the folder: " + failure.message(), folder.string(),
                "choose another with --output");
  files::write_whole(folder / "report.md", texts.markdown, "the report");
  files::write_whole(folder / "report.json", texts.json, "the report");
  files::write_whole(folder / "report.html", texts.html, "the report");
}

}  // namespace thermorig::app
