// SPDX-License-Identifier: MIT
#include "session_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "print/output.h"
#include "print/reading_progress.h"
#include "thermorig/core/error.h"

namespace thermorig::app {

namespace {

namespace fs = std::filesystem;

dataset::Acquisitions read_files(const std::vector<fs::path>& files, const SessionOptions& options) {
  ReadingProgress progress(options.json, ReadingProgress::Elsewhere::lines);
  const auto leaves_out = [&](const fs::path& file) {
    return !options.accept_bad && !is_named(file, options.paths);
  };
  return dataset::read_acquisitions(files, std::ref(progress), options.label, options.packs, leaves_out);
}

std::vector<std::string> files_of(const std::vector<dataset::BadSession>& bad) {
  std::vector<std::string> files;
  for (const dataset::BadSession& session : bad) files.push_back(session.file.string());
  return files;
}

std::vector<std::string> strings_of(const std::vector<fs::path>& files) {
  return {files.begin(), files.end()};
}

/// The first of them, a line each.
std::string some_of(const std::vector<std::string>& files) {
  constexpr std::size_t most = 3;
  std::string text;
  for (std::size_t i = 0; i < std::min(most, files.size()); ++i) text += "\n  " + printable(files[i]);
  if (files.size() > most) text += fmt::format("\n  and {} more", files.size() - most);
  return text;
}

/// Files of rigs without a servo.
std::vector<std::string> labelled_by_gyro(const dataset::Acquisitions& data) {
  std::vector<std::string> files;
  for (std::size_t i = 0; i < data.acquisitions.size(); ++i)
    if (data.acquisitions[i].is_labelled_by_gyro) files.push_back(data.files[i].string());
  return files;
}

void tell_labels(const std::vector<std::string>& files) {
  if (files.empty()) return;
  print(
      "labels from the gyro (no servo): gyro estimators are compared with themselves;\n"
      "trust those of images alone:{}\n",
      some_of(files));
}

void tell_choice(const dataset::Acquisitions& data) {
  tell_labels(labelled_by_gyro(data));
  if (!data.for_calibration.empty())
    print("left out, recorded for calibrations:{}\n", some_of(strings_of(data.for_calibration)));
  tell_left_out(data.left_out);
  if (!data.bad.empty()) print("bad, but accepted:{}\n", some_of(files_of(data.bad)));
}

void require_any(const dataset::Acquisitions& data) {
  if (!data.acquisitions.empty()) return;
  require_good(data.left_out, false);
  throw Error(ExitCode::bad_usage, "was recorded for a calibration, and there is no other session",
              data.for_calibration.front().string(),
              "record some to learn from: thermorig record --environment NAME");
}

}  // namespace

bool is_named(const fs::path& file, const std::vector<fs::path>& paths) {
  return std::any_of(paths.begin(), paths.end(), [&](const fs::path& path) {
    std::error_code hidden;
    return fs::equivalent(path, file, hidden);
  });
}

void tell_left_out(const std::vector<dataset::BadSession>& bad) {
  constexpr std::size_t most = 3;
  for (std::size_t i = 0; i < std::min(most, bad.size()); ++i)
    print("left out, verdict bad: {}\n  {}\n", printable(bad[i].file.string()),
          printable(fmt::format("{}", fmt::join(bad[i].reasons, "; "))));
  if (bad.size() > most) print("left out, verdict bad: {} more\n", bad.size() - most);
  if (!bad.empty()) print("  (--accept-bad takes them)\n");
}

void require_good(const std::vector<dataset::BadSession>& bad, bool accepted) {
  if (bad.empty() || accepted) return;
  const std::string others = bad.size() > 1 ? fmt::format(" (and {} more are bad)", bad.size() - 1) : "";
  throw Error(ExitCode::check_failed,
              fmt::format("the session's verdict is bad: {}{}", fmt::join(bad.front().reasons, "; "), others),
              bad.front().file.string(),
              "leave it out, make it again from its raw bytes (thermorig reprocess FILE), or take it as it "
              "is: --accept-bad");
}

dataset::Acquisitions read_data(const SessionOptions& options) {
  dataset::Acquisitions data = read_files(dataset::find_sessions(options.paths), options);
  require_any(data);
  require_good(data.bad, options.accept_bad);
  if (!options.json) tell_choice(data);
  return data;
}

void run_estimators(dataset::Acquisitions& data, bool json, const dataset::IsWanted& is_wanted,
                    int bound_frames) {
  ReadingProgress progress(json, ReadingProgress::Elsewhere::lines, "running estimators over sessions");
  dataset::run_estimators_over(data, is_wanted, bound_frames, std::ref(progress));
}

void add_choice_to(nlohmann::json& object, const dataset::Acquisitions& data) {
  std::vector<std::string> left_out = strings_of(data.for_calibration);
  for (std::string& file : files_of(data.left_out)) left_out.push_back(std::move(file));
  object["left_out"] = left_out;
  object["bad"] = files_of(data.bad);
  object["labels_from_gyro"] = labelled_by_gyro(data);
}

SessionOptions session_options(const EvaluateOptions& options) {
  return {.paths = options.paths,
          .accept_bad = options.accept_bad,
          .json = options.json,
          .label = label_named(options.label.value_or("commanded"))};
}

bool any_simulated(const std::vector<network::Acquisition>& acquisitions) {
  return std::any_of(acquisitions.begin(), acquisitions.end(),
                     [](const network::Acquisition& acquisition) { return acquisition.simulated; });
}

}  // namespace thermorig::app
