// SPDX-License-Identifier: MIT
#include <algorithm>

#include "result_file.h"
#include "thermorig/core/error.h"

namespace thermorig::study {

namespace {

namespace fs = std::filesystem;

void check_same_data(const JobResult& first, const fs::path& first_path, const JobResult& other,
                     const fs::path& other_path) {
  if (first.job.data_hash == other.job.data_hash) return;
  throw Error(ExitCode::bad_usage, "this result is of other sessions than " + first_path.filename().string(),
              other_path.string(), "keep the results of each set of sessions in a folder of its own");
}

}  // namespace

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
