// SPDX-License-Identifier: MIT
#include "study_jobs.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "evaluate_parts.h"
#include "print/output.h"
#include "session_data.h"

namespace thermorig::app {

namespace {

namespace fs = std::filesystem;

/// The paper's reference setting where it is part of the study, else the first that is.
int reference_of(const std::vector<int>& values, int usual) {
  const bool there = std::find(values.begin(), values.end(), usual) != values.end();
  return there || values.empty() ? usual : values.front();
}

study::StudyConfig config_of(const EvaluateOptions& options) {
  study::StudyConfig config;
  config.environment = options.environment;
  config.frames = options.frames;
  config.reductions = options.reductions;
  config.reference_frames = reference_of(options.frames, config.reference_frames);
  config.reference_reduction = reference_of(options.reductions, config.reference_reduction);
  config.seeds = options.seeds;
  config.reference_seeds = options.reference_seeds;
  config.preset = options.preset;
  config.epochs = options.epochs;
  config.history = options.history.value_or(0);
  return config;
}

void print_state(const study::Job& job, bool done, bool json) {
  const char* const state = done ? "done" : "open";
  if (json)
    print_json({{"event", "listed"},
                {"id", study::id_of(job)},
                {"job", study::description_of(job)},
                {"state", state}});
  else
    write_to(stdout, fmt::format("{}  {}\n", study::id_of(job), state));  // for programs, too: never folded
}

}  // namespace

std::vector<study::Job> jobs_of_study(const EvaluateOptions& options,
                                      const std::vector<network::Acquisition>& acquisitions) {
  return study::jobs_of(config_of(options), acquisitions);
}

void require_results_folder(const EvaluateOptions& options) {
  if (options.output.empty())
    throw Error(ExitCode::bad_usage, "a study needs a folder for its results", "", "-o study");
}

void require_complete(const std::vector<study::Job>& jobs, const fs::path& folder, bool json) {
  const std::vector<study::Job> open = study::without_result(jobs, folder);
  if (open.empty()) return;
  for (const study::Job& job : open) print_state(job, false, json);
  flush_output();
  throw Error(ExitCode::check_failed,
              fmt::format("{} of the study's {} results are missing", open.size(), jobs.size()),
              folder.string(), "run the study again: it goes on with what is missing");
}

ExitCode list_jobs(const EvaluateOptions& options) {
  require_results_folder(options);
  SessionOptions sessions = session_options(options);
  sessions.json = true;  // lines are for programs, and for nothing but jobs
  const std::vector<study::Job> jobs = jobs_of_study(options, read_data(sessions).acquisitions);
  const std::vector<study::Job> open = study::without_result(jobs, options.output / "results");
  const std::set<study::Job> left(open.begin(), open.end());
  for (const study::Job& job : jobs) print_state(job, !left.contains(job), options.json);
  if (options.json)
    print_json(
        {{"event", "summary"}, {"exit_code", 0}, {"done", jobs.size() - left.size()}, {"open", left.size()}});
  return ExitCode::ok;
}

}  // namespace thermorig::app
