// SPDX-License-Identifier: MIT
#include "plot_files.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <optional>
#include <string>

#include "print/output.h"
#include "thermorig/core/error.h"
#include "thermorig/core/printable.h"
#include "thermorig/io/files/whole_file.h"

namespace thermorig::app {

namespace {

namespace fs = std::filesystem;

constexpr const char* converter = "rsvg-convert";

/// The environment, with a time for what is dated: one input, one PDF.
std::vector<char*> undated_environment() {
  static char epoch[] = "SOURCE_DATE_EPOCH=0";
  std::vector<char*> variables;
  for (char** variable = environ; *variable != nullptr; ++variable) variables.push_back(*variable);
  if (::getenv("SOURCE_DATE_EPOCH") == nullptr) variables.push_back(epoch);
  variables.push_back(nullptr);
  return variables;
}

/// Exit code of the program, or nothing if it is not installed.
std::optional<int> exit_of(std::vector<std::string> words) {
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const std::vector<char*> variables = undated_environment();
  pid_t child = 0;
  const int failure =
      ::posix_spawnp(&child, arguments[0], nullptr, nullptr, arguments.data(), variables.data());
  if (failure == ENOENT || failure == EACCES) return std::nullopt;
  int status = failure == 0 ? 0 : -1;
  while (failure == 0 && ::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (failure == 0 && WIFEXITED(status) && WEXITSTATUS(status) == 127) return std::nullopt;
  return status;
}

/// Whether the converter is there. PNG has twice the pixels, for screens and slides.
bool convert(const fs::path& svg) {
  for (const char* kind : {"pdf", "png"}) {
    fs::path made = svg;
    made.replace_extension(kind);
    const std::optional<int> status = exit_of({converter, std::string("--format=") + kind,
                                               kind == std::string_view("png") ? "--zoom=2" : "--zoom=1",
                                               "--output=" + made.string(), "--", svg.string()});
    if (!status) return false;
    if (*status != 0)
      throw Error(ExitCode::failed, std::string(converter) + " could not convert a figure", svg.string(),
                  "the SVG files are complete; its message is above");
  }
  return true;
}

}  // namespace

void require_plots_possible(const fs::path& folder) {
  report::require_charts();
  std::error_code failure;
  const bool is_there = fs::exists(folder, failure);
  if (!is_there || (fs::is_directory(folder, failure) && fs::is_empty(folder, failure))) return;
  throw Error(ExitCode::storage, "the folder for plots is not empty, and nothing is overwritten",
              folder.string(), "another folder, or remove this one first");
}

void write_plots(const fs::path& folder, const std::vector<report::PlotFile>& files) {
  require_plots_possible(folder);
  std::error_code failure;
  fs::create_directories(folder, failure);
  if (failure)
    throw Error(ExitCode::storage, "cannot make the folder: " + failure.message(), folder.string(),
                "another folder with --plots");
  for (const report::PlotFile& file : files) files::write_whole(folder / file.name, file.text, "the plot");
  for (const report::PlotFile& file : files)
    if (file.name.ends_with(".svg") && !convert(folder / file.name)) {
      print(stderr,
            "note  no PDF and PNG of the figures: {} is not installed\n      try: apt install librsvg2-bin\n",
            converter);
      return;
    }
}

}  // namespace thermorig::app
