// SPDX-License-Identifier: MIT
#include "result_file.h"

#include <fmt/format.h>
#include <algorithm>

#include "fingerprint.h"
#include "thermorig/core/error.h"
#include "thermorig/io/files/part_file.h"
#include "thermorig/io/files/whole_file.h"

namespace thermorig::study {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t max_file_bytes = 4'000'000;  // a result has below 20 kB
const std::string noun = "the result";
constexpr std::string_view result_extension = ".json";

/// Only letters, digits, '-' and '_': a name in a session must not lead out of the folder.
std::string safe_name(const std::string& text) {
  std::string name = text.substr(0, 80);
  std::replace_if(
      name.begin(), name.end(),
      [](char c) {
        const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
        return !letter && !(c >= '0' && c <= '9') && c != '-' && c != '_';
      },
      '_');
  return name;
}

/// Every field of a job on a line of its own.
std::string text_of(const Job& job) {
  // A study that was begun while there was no choice of the label goes on.
  const std::string label =
      job.label == Label::commanded ? "" : fmt::format("label {}\n", name_of(job.label));
  return fmt::format("{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}\n{}", job.engine, job.frames,
                     job.reduction, job.fusion, job.seed, job.preset, job.settings, job.epochs, job.history,
                     job.test, job.test_hash, job.data_hash, label);
}

void check_same_data(const JobResult& first, const fs::path& first_path, const JobResult& other,
                     const fs::path& other_path) {
  if (first.job.data_hash == other.job.data_hash) return;
  throw Error(ExitCode::bad_usage, "this result is of other sessions than " + first_path.filename().string(),
              other_path.string(), "keep the results of each set of sessions in a folder of its own");
}

}  // namespace

std::string file_name_of(const Job& job) {
  constexpr std::size_t digits = 12;
  return fmt::format("{}_nf{}_nr{}_{}_{}_seed{}_{}.json", safe_name(job.test), job.frames, job.reduction,
                     job.fusion ? "fusion" : "thermal", safe_name(job.preset), job.seed,
                     fingerprint_of(text_of(job)).substr(0, digits));
}

std::string id_of(const Job& job) {
  return fs::path(file_name_of(job)).stem();
}

void write_result(const fs::path& folder, const JobResult& result) {
  files::write_whole_if_free(folder / file_name_of(result.job), to_json(result), noun);
}

void replace_result(const fs::path& folder, const JobResult& result) {
  files::write_whole(folder / file_name_of(result.job), to_json(result), noun);
}

JobResult read_result(const fs::path& path) {
  const std::vector<std::uint8_t> bytes = files::read_whole(path, max_file_bytes, noun);
  return result_from_json({bytes.begin(), bytes.end()}, path.string());
}

std::optional<JobResult> find_result(const fs::path& folder, const Job& job) {
  const fs::path path = folder / file_name_of(job);
  std::error_code hidden;  // a folder that may not be searched: reading says so
  if (fs::status(path, hidden).type() == fs::file_type::not_found) return std::nullopt;
  JobResult result = read_result(path);
  if (result.job == job) return result;
  throw Error(ExitCode::not_a_session, "this result holds another job than its name says", path.string(),
              "delete it and run the study again: only this job is then repeated");
}

std::vector<fs::path> result_files(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code failure, hidden;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, failure))
    if (entry.path().extension() == ".json" && entry.is_regular_file(hidden)) files.push_back(entry.path());
  if (failure)
    throw Error(ExitCode::bad_usage, "the folder of results cannot be read: " + failure.message(),
                folder.string(), "name the folder that `thermorig evaluate --study -o` wrote");
  std::sort(files.begin(), files.end());
  return files;
}

void make_results_folder(const fs::path& folder) {
  std::error_code failure;
  fs::create_directories(folder, failure);
  if (!failure) return;
  throw Error(ExitCode::storage, "cannot make the folder of results: " + failure.message(), folder.string(),
              "choose another folder with --output");
}

void remove_litter(const fs::path& folder) {
  std::error_code ignored;  // what cannot be removed is in nobody's way
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored))
    if (const auto left = files::left_part_of(entry.path()); left && left->extension() == result_extension)
      files::remove_unless_held(entry.path());
}

std::vector<JobResult> read_results(const fs::path& folder) {
  const std::vector<fs::path> files = result_files(folder);
  if (files.empty())
    throw Error(ExitCode::bad_usage, "no results of a study lie in this folder", folder.string(),
                "thermorig evaluate --study SESSIONS -o DIR writes them to DIR/results");
  std::vector<JobResult> results;
  for (const fs::path& file : files) {
    results.push_back(read_result(file));
    check_same_data(results.front(), files.front(), results.back(), file);
  }
  return results;
}

std::vector<JobResult> results_of(std::span<const Job> jobs, const fs::path& folder) {
  std::vector<JobResult> results;
  for (const Job& job : jobs)
    if (std::optional<JobResult> result = find_result(folder, job)) results.push_back(std::move(*result));
  return results;
}

}  // namespace thermorig::study
