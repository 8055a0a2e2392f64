// SPDX-License-Identifier: MIT
#include "report_files.h"

#include "print/output.h"
#include "thermorig/core/error.h"
#include "thermorig/io/files/whole_file.h"
#include "thermorig/learning/report/report.h"

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
  if (!report::draws_charts())
    print(stderr,
          "note  report.html has no charts, as this program was built without node: bash app/setup.sh page, "
          "then cmake --preset release && cmake --build build\n");
}

}  // namespace thermorig::app
