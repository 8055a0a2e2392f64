// SPDX-License-Identifier: MIT
#include "report_files.h"

#include <cerrno>
#include <cstring>
#include <fstream>

#include "thermorig/core/error.h"

namespace thermorig::app {

namespace {

void write_text(const std::filesystem::path& path, const std::string& text) {
  errno = 0;
  std::ofstream file(path, std::ios::binary);
  file.write(text.data(), static_cast<std::streamsize>(text.size()));
  file.close();
  if (file.fail())
    throw Error(ExitCode::storage, std::string("cannot write the report: ") + std::strerror(errno),
                path.string(), "choose another folder with --output");
}

}  // namespace

void write_report(const std::filesystem::path& folder, const ReportTexts& texts) {
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure)
    throw Error(ExitCode::storage, "cannot make the folder: " + failure.message(), folder.string(),
                "choose another with --output");
  write_text(folder / "report.md", texts.markdown);
  write_text(folder / "report.json", texts.json);
  write_text(folder / "report.html", texts.html);
}

}  // namespace thermorig::app
